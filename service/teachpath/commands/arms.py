"""arm: arms from models in URDF and MJCF, which are kept with versions in the data folder."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.audit import note
from teachpath.commands.options import Config, Data, Json, opened_store, stored_settings
from teachpath.commands.printing import print_answer, print_columns, print_json, print_list
from teachpath.errors import UnusableInput
from teachpath_proto.keys import is_name, name_refusal

if TYPE_CHECKING:
    from teachpath.records import Pose, RevoluteJoint, SerialArm
    from teachpath.records.serial_arms import JointLimit

app: typer.Typer = typer.Typer(
    help="Arms from models in URDF and MJCF: add, list, check (docs/arms.md).", no_args_is_help=True
)

Tool = Annotated[
    str, typer.Option(help="Name of the body or site that is the tool, or its pose to the last link, as --base.")
]
Base = Annotated[str, typer.Option(help="Pose of the model to the world: x,y,z [m], or x,y,z,qw,qx,qy,qz.")]
Gripper = Annotated[bool, typer.Option("--gripper", help="Mount teachpath's own gripper on the tool's frame.")]
Limits = Annotated[Path | None, typer.Option(help="TOML file with what the model does not say (docs/arms.md).")]
MODEL = "Model in URDF or MJCF; or six-axis, seven-axis: examples that come with teachpath."


@app.command("add")
def add(
    name: Annotated[str, typer.Argument(help="Of the arm.")],
    file: Annotated[str, typer.Argument(help=MODEL)],
    base: Base = "",
    tool: Tool = "",
    limits: Limits = None,
    gripper: Gripper = False,
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Read an arm from its model and keep it; a changed one becomes the next version of its name."""
    if not is_name(name):
        raise UnusableInput(name_refusal("arm", name))
    settings = stored_settings(config, data, may_make=True)
    arm = _read(file, name, base, tool, limits, gripper)
    with opened_store(settings) as store:
        stored = store.arms.add(arm, Path(file).name)
    note(settings, f"add arm {name}@{stored.version} of {Path(file).name}, {stored.hash}")
    moves = f"Make it the arm of the station: teachpath serve --arm {name} (setting motion.arm)"
    said = f"arm {name}@{stored.version}: {len(arm.links)} joints, {stored.hash[:12]}"
    print_answer(stored, said, *_notes(arm), moves, json_=json_)


@app.command("list")
def list_(config: Config = None, data: Data = None, json_: Json = False) -> None:
    """List the arms that are kept, each in its newest version."""
    with opened_store(stored_settings(config, data)) as store:
        kept = store.arms.newest()
    rows = [(each.arm.name, each.version, len(each.arm.links), each.file, each.hash[:12]) for each in kept]
    print_list(
        kept,
        ("arm", "version", "joints", "model", "hash"),
        rows,
        none="no arms yet; add one with: teachpath arm add",
        json_=json_,
    )


@app.command("check")
def check(
    arm: Annotated[str, typer.Argument(help=f"One that is kept. {MODEL}")],
    base: Base = "",
    tool: Tool = "",
    limits: Limits = None,
    gripper: Gripper = False,
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Say what an arm's model has: joints with limits and who gave them, masses, and which links may collide."""
    if Path(arm).suffix or arm in _examples():
        checked = _read(arm, "", base, tool, limits, gripper)
    else:
        with opened_store(stored_settings(config, data)) as store:
            checked = store.arms.versions(arm)[0].arm
    sentences = [*_collisions(checked), *_notes(checked)]
    if json_:
        print_json({"arm": asdict(checked), "notes": sentences})
        return
    rows = [
        (joint.name, f"{_angle(joint.lower)} to {_angle(joint.upper)}", *map(_limit, _rates(joint)))
        for joint in checked.joints
    ]
    heads = ("joint", "range [deg]", "speed [rad/s]", "acceleration [rad/s^2]", "jerk [rad/s^3]", "torque [N m]")
    print_columns(heads, rows, none="")
    print(f"mass {sum(link.mass for link in checked.links):.2f} kg; every link's inertia is one that a body can have")
    for sentence in sentences:
        print(sentence)


def _collisions(arm: SerialArm) -> Iterator[str]:
    from teachpath.motion.collision.self_collision import SAMPLES, self_collision_pairs

    pairs = self_collision_pairs(arm)
    names = ["base", *(link.name for link in arm.links)]

    def words(of: tuple[tuple[int, int], ...]) -> str:
        return ", ".join(f"{names[one]} and {names[other]}" for one, other in of) or "none"

    yield f"of {SAMPLES} configurations, these overlap in some: {words(pairs.meeting)}"
    yield f"checked as well, though they never met: {words(pairs.separate)}"
    yield f"not checked: {len(pairs.neighbours)} pairs of neighbours; always overlapping: {words(pairs.overlapping)}"


def _notes(arm: SerialArm) -> Iterator[str]:
    """Yield what an operator should know: joints that are held, and limits that nobody gave."""
    if arm.held:
        yield f"held where the model has them: {', '.join(arm.held)}"
    for kind in ("speed", "acceleration", "jerk", "torque"):
        limits = [getattr(joint, kind) for joint in arm.joints]
        if missing := sum(limit.source == "default" for limit in limits):
            values = sorted({f"{limit.value:.4g}" for limit in limits if limit.source == "default"}, key=float)
            span = " to ".join(values[:: max(len(values) - 1, 1)])
            yield f"nobody says the {kind} of {missing} joints; taken as {span}"


def _rates(joint: RevoluteJoint) -> Iterator[JointLimit]:
    return (getattr(joint, kind) for kind in ("speed", "acceleration", "jerk", "torque"))


def _angle(limit: JointLimit) -> str:
    return f"{degrees(limit.value):.1f}{_mark(limit)}"


def _limit(limit: JointLimit) -> str:
    return f"{limit.value:.4g}{_mark(limit)}"


def _mark(limit: JointLimit) -> str:
    return "" if limit.source == "model" else f" ({limit.source})"


def _examples() -> list[str]:
    from teachpath.io.arm_models.examples import EXAMPLES

    return list(EXAMPLES)


def _read(file: str, name: str, base: str, tool: str, limits: Path | None, gripper: bool) -> SerialArm:
    from teachpath.io.arm_models.arm_reader import read_arm
    from teachpath.motion.arm.puma560 import TOOL_LENGTH
    from teachpath.records.serial_arms import NO_POSE

    return read_arm(
        file,
        name=name,
        base=_pose("--base", base) if base else NO_POSE,
        tool=(_pose("--tool", tool) if "," in tool else tool) or None,
        limits=limits,
        gripper_length=TOOL_LENGTH if gripper else 0.0,
    )


def _pose(option: str, text: str) -> Pose:
    from teachpath.records.poses import unit_quaternion

    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) not in (3, 7) or not all(abs(value) <= 100.0 for value in values):
        raise UnusableInput(f"{option} {text} is not x,y,z or x,y,z,qw,qx,qy,qz, in metres")
    x, y, z = values[:3]
    return (x, y, z), unit_quaternion(values[3:] or (1.0, 0.0, 0.0, 0.0), option)
