"""The arm that the demo moves, where it is not the Puma 560: one that is kept, or an example that is added first."""

from __future__ import annotations

from typing import Final

from teachpath.commands.options import opened_store
from teachpath.config import Settings
from teachpath.errors import UnusableInput
from teachpath.io.arm_models.arm_reader import read_arm
from teachpath.io.arm_models.examples import EXAMPLES
from teachpath.motion.arm.puma560 import TOOL_LENGTH, VARIANTS
from teachpath.records import Pose, SerialArm
from teachpath.stored_arm import with_stored_arm

# Where the examples stand at the table of the demo.
PLACE: Final[Pose] = ((0.05, 0.0, 0.5), (1.0, 0.0, 0.0, 0.0))


def prepare_arm(settings: Settings, *, carries: bool) -> None:
    """Check that the demo can move the arm of the settings; an example is added to the data folder.

    Args:
        settings: of the demo.
        carries: whether there is an object to carry.

    Raises:
        UnusableInput: there is no such arm, or it has no gripper for the object.
    """
    name = settings.motion.arm
    if name is None:
        return
    with opened_store(settings) as store:
        kept = [stored.arm.name for stored in store.arms.newest()]
        if name not in kept:
            store.arms.add(_example(name, settings, kept), EXAMPLES[name].name)
        arm = with_stored_arm(settings, store.arms).arm
    if carries and not arm.has_gripper:
        raise UnusableInput(
            f"--arm {name} has no gripper, and the demo has a block to carry; add it with one: teachpath arm add "
            f"{name} MODEL --gripper"
        )


def _example(name: str, settings: Settings, kept: list[str]) -> SerialArm:
    if name not in EXAMPLES:
        raise UnusableInput(
            f"there is no arm {name!r}: published ones are {', '.join(VARIANTS)}, examples {', '.join(EXAMPLES)}, in "
            f"this data folder {', '.join(kept) or 'none'}; add yours with: teachpath arm add {name} MODEL --gripper"
        )
    return read_arm(name, name=name, base=PLACE, gripper_length=TOOL_LENGTH)
