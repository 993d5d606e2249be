"""Interpreters of the subsets of robots' languages that programs are written in; an unknown line is an error."""

import re
from itertools import pairwise

import numpy as np

NUMBER = r"(-?\d+\.\d+)"
SIX_NUMBERS = ", ?".join([NUMBER] * 6)

Motion = tuple[np.ndarray, np.ndarray]  # times (n,) [s], joints (n, 6) [rad]


def urscript(text: str) -> Motion:
    head, _, tail = text.partition("  local present = ")
    assert re.fullmatch(r"def [a-z]\w*\(\):\n(  # [ -~]+\n)+", head)
    start = re.search(rf"local start = \[{SIX_NUMBERS}\]\n", tail)
    assert start
    rows, time = [(0.0, _joints(start.groups()))], 0.0
    for line in tail[tail.index("  servoj") :].splitlines():
        if line in ("  stopj(2.0)", "end"):
            continue
        step = re.fullmatch(rf"  servoj\(\[{SIX_NUMBERS}\], 0, 0, {NUMBER}, 0\.03, 300\)", line)
        assert step, line
        time += float(step[7])
        rows.append((time, _joints(step.groups()[:6])))
    return _motion(rows)


def rapid(text: str) -> Motion:
    start = re.findall(rf"IF Abs\(present\.robax\.rax_(\d) - \({NUMBER}\)\) > 0\.6 THEN", text)
    assert [int(axis) for axis, _ in start] == [1, 2, 3, 4, 5, 6]
    rows, time = [(0.0, np.radians(_joints([value for _, value in start])))], 0.0
    for line in text.splitlines():
        if "MoveAbsJ" not in line:
            assert re.match(
                r"MODULE |  ! |  PROC \w+\(\)|  ENDPROC|ENDMODULE|    (VAR|present|IF|  TP|  EXIT|ENDIF)", line
            ), line
            continue
        move = re.fullmatch(
            rf"    MoveAbsJ \[\[{SIX_NUMBERS}\],\[9E9(?:,9E9){{5}}\]\], v1000 \\T:={NUMBER}, (z0|fine), tool0;", line
        )
        assert move, line
        time += float(move[7])
        rows.append((time, np.radians(_joints(move.groups()[:6]))))
    assert text.count(", fine,") == 1
    return _motion(rows)


def krl(text: str) -> Motion:
    start = re.findall(rf"IF ABS\(\$AXIS_ACT\.A(\d) - \({NUMBER}\)\) > 0\.6 THEN\nHALT\nENDIF\n", text)
    assert [int(axis) for axis, _ in start] == [1, 2, 3, 4, 5, 6]
    block = re.search(
        rf"PTP_SPLINE\nTIME_BLOCK START\n(.*)TIME_BLOCK END = {NUMBER}\nENDSPLINE\nEND\n$", text, re.DOTALL
    )
    assert block
    axes = ",".join(f"A{axis} {NUMBER}" for axis in range(1, 7))
    parts, rows = [], [_joints([value for _, value in start])]
    for point, part in pairwise(block[1].splitlines()[:]):
        if step := re.fullmatch(rf"SPTP \{{{axes}\}}", point):
            share = re.fullmatch(r"TIME_BLOCK PART = (\d+)", part)
            assert share
            parts.append(int(share[1]))
            rows.append(_joints(step.groups()))
    shares = np.concatenate([[0.0], np.cumsum(parts)]) / sum(parts)
    return shares * float(block[2]), np.radians(rows)


def ls(text: str) -> Motion:
    program, _, positions = text.partition("/POS\n")
    points = {}
    for number, body in re.findall(r"P\[(\d+)\]\{\n   GP1:\n\tUF : 0, UT : 1,\n(.*?)\n\};\n", positions, re.DOTALL):
        values = re.findall(rf"J(\d)= {NUMBER} deg", body)
        assert [int(joint) for joint, _ in values] == [1, 2, 3, 4, 5, 6]
        points[int(number)] = np.radians(_joints([value for _, value in values]))
    rows, time = [], 0.0
    for count, line in enumerate(program.partition("/MN\n")[2].splitlines(), 1):
        number, _, statement = line.partition(":")
        assert int(number) == count
        if re.fullmatch(r"  (![ -:<-~]{1,30}|PAUSE) ;", statement):
            continue
        move = re.fullmatch(r"J P\[(\d+)\] (5%|(\d+)msec) (FINE|CNT100) ;", statement)
        assert move, line
        time += float(move[3] or 0) / 1000
        rows.append((time, points[int(move[1])]))
    return _motion(rows)


INTERPRETERS = {"urscript": urscript, "rapid": rapid, "krl": krl, "ls": ls}


def _joints(values: object) -> np.ndarray:
    return np.array(values, dtype=float)


def _motion(rows: list[tuple[float, np.ndarray]]) -> Motion:
    times, joints = zip(*rows, strict=True)
    return np.array(times), np.array(joints)
