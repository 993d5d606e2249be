"""A motion as a program of a robot's controller, by a template for each."""

from __future__ import annotations

import re
import textwrap
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from teachpath.io.programs.robot_targets import RobotTarget, check_target, largest_deviation
from teachpath.records import SampledMotion

if TYPE_CHECKING:
    from jinja2 import Environment

TEMPLATES: Final = Path(__file__).parent / "templates"
MAX_NAME: Final = 24  # characters of the name of a program
DECIMALS: Final = 9  # of radians and degrees


def robot_program(motion: SampledMotion, target: RobotTarget) -> bytes:
    """Write a motion as a program; its first lines say whose joints they are, what was proved, and what was not.

    The arm has to stand at the first point when the program begins.

    Raises:
        UnusableInput: the controller cannot hold what the plan promises.
    """
    check_target(motion, target)
    joints = np.degrees(motion.positions) if target.degrees else motion.positions
    template = _environment().get_template(target.template)
    text = template.render(
        name=_program_name(motion.name),
        remarks=_remarks(motion, target),
        points=[[f"{value:.{DECIMALS}f}" for value in point] for point in joints.tolist()],
        period=f"{1.0 / motion.rate:.6f}",
        period_ms=f"{1e3 / motion.rate:.0f}",
        duration=f"{(len(motion.times) - 1) / motion.rate:.6f}",
    )
    return text.encode("ascii")


def _remarks(motion: SampledMotion, target: RobotTarget) -> list[str]:
    deviation, _, _ = largest_deviation(motion, target)
    unit = "degrees" if target.degrees else "radians"
    own = (
        f"{target.title}: {len(motion.times)} points {1e3 / motion.rate:g} ms apart, joints in {unit}. These are the "
        "angles of the arm above: shift, turn and couple them as the arm at hand counts its own before it moves.",
        "The arm has to stand at the first point when the program begins.",
        f"Between the points the controller may leave the plan by up to {deviation:.5f} rad; what its filters and "
        "look-ahead add is not known here.",
    )
    lines = (textwrap.wrap(_plain(note), target.remark_width, break_on_hyphens=False) for note in (*motion.notes, *own))
    return [line for wrapped in lines for line in wrapped]


def _plain(note: str) -> str:
    """Return a note as a remark can hold it: of printable ASCII, without what ends a statement."""
    ascii_ = note.replace("µ", "u").replace(";", ",").encode("ascii", "replace").decode()
    return re.sub(r"[^ -~]", " ", ascii_)


def _program_name(name: str) -> str:
    return re.sub(r"\W", "_", f"p_{name}", flags=re.ASCII)[:MAX_NAME]


@cache
def _environment() -> Environment:
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # here, because few stations write programs

    return Environment(
        loader=FileSystemLoader(TEMPLATES),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
