"""run --check: judge a log of setpoints."""

from __future__ import annotations

import sys
from dataclasses import asdict
from pathlib import Path

import numpy as np

from teachpath.commands.options import connected, with_arm
from teachpath.commands.printing import print_json
from teachpath.commands.references import find_plan
from teachpath.config import load
from teachpath.errors import UnusableRecording
from teachpath.io.documents import from_document
from teachpath.io.setpoints import read_setpoints
from teachpath.io.store.motions import read_motion
from teachpath.motion.analysis.log_check import SetpointLog, check_log
from teachpath.motion.planning.signature import certified_arm
from teachpath.nurbs import Curve
from teachpath.records import Plan


def judge_file(file: Path, plan: str | None, url: str, config: Path | None, *, json_: bool = False) -> None:
    """Judge a log of setpoints, print what was measured, and end with status 1 and a sentence when it breaks something.

    Args:
        file: a recording of an execution (MCAP), or a CSV.
        plan: id of the plan that was meant, when the file does not say.
        url: of the service that has it.
        config: settings file, which names the arm where no signed plan does.
        json_: whether one JSON object is printed: file, arm, joints, measured, faults.
    """
    try:
        content = file.read_bytes()
    except OSError as error:
        raise UnusableRecording(f"{file} cannot be read: {error.strerror}") from None
    if content[1:5] == b"MCAP":
        log, meant, path = _read_motion(file)
    else:
        log, meant, path = _read_csv(content, file.name), None, None
    if plan is not None:
        meant, path = _meant(plan, url)
    arm = with_arm(load(config)).arm
    judged = (meant and certified_arm(meant, arm)) or arm
    judgement = check_log(log, path, judged)
    if json_:
        measured = {"measured": judgement.measured, "faults": judgement.faults}
        print_json({"file": str(file), "arm": judged.name, "joints": judged.limits.names, **measured})
    else:
        for sentence in judgement.measured:
            print(sentence)
        for sentence in judgement.faults:
            print(f"BROKEN: {sentence}")
    if judgement.faults:
        sys.exit(f"teachpath: {file.name} breaks {len(judgement.faults)} of what it must keep: {judgement.faults[0]}")
    if not json_:
        print(f"{file.name} keeps every limit" + (" and the path" if path is not None else ""))


def _read_motion(file: Path) -> tuple[SetpointLog, Plan | None, Curve | None]:
    motion = read_motion(file)
    if len(motion.setpoints) < 4:
        why = motion.fault or f"it has {len(motion.setpoints)} setpoints"
        raise UnusableRecording(f"{file.name} holds no motion that could be judged: {why}")
    if motion.fault:
        print(f"{file.name} is damaged ({motion.fault}); judged up to there", file=sys.stderr)
    sent = motion.setpoints
    cycles = np.array([s.cycle for s in sent])
    log = SetpointLog(
        times=np.array([s.nominal_ns - sent[0].nominal_ns for s in sent]) / 1e9,
        positions=np.array([s.position for s in sent]),
        on_path=np.array([s.on_path for s in sent]),
        missing=int(np.sum(np.diff(cycles) - 1)),
        restarts=tuple(row for row, s in enumerate(sent) if row and s.from_rest),
    )
    path = motion.header.path if motion.header else None
    return log, motion.header.plan if motion.header else None, path.curve if path else None


def _read_csv(content: bytes, name: str) -> SetpointLog:
    times, positions, on_path = read_setpoints(content, name)
    return SetpointLog(times, positions, on_path != 0.0 if on_path is not None else None)


def _meant(plan: str, url: str) -> tuple[Plan, Curve]:
    """Ask the service for a plan and its path."""
    with connected(url) as station:
        stored = station.get_plan(find_plan(station, plan))
        curve = station.get_version(stored.path, stored.path_version).path.curve
    return from_document(Plan, asdict(stored)), from_document(Curve, asdict(curve))
