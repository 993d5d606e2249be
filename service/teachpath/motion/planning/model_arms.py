"""What is planned for an arm that a user's model describes, and what is not."""

from __future__ import annotations

from dataclasses import replace

from teachpath.errors import UnusableInput, UnusableSettings
from teachpath.motion.arm.model import Arm
from teachpath.motion.settings import MotionSettings
from teachpath.records import Scene, ShownPosture


def check_plannable(arm: Arm, scene: Scene, shown: ShownPosture | None = None) -> None:
    """Check that plans are made for an arm in a scene, near to the joints that were shown.

    Raises:
        UnusableInput: there is an object to carry, and no gripper to take it; or the joints are another arm's.
    """
    if shown is not None and (count := shown.joints.shape[1]) != arm.joint_count:
        raise UnusableInput(
            f"demonstration {shown.demonstration} was shown by an arm of {count} joints, and {arm.name} has "
            f"{arm.joint_count}: its posture cannot be preferred"
        )
    if arm.model is None and scene.carried is not None and not arm.has_gripper:
        raise UnusableInput(
            f"motion.gripper is none, and scene {scene.name} has {scene.carried.name} to carry; plan in a scene "
            "without an object, where the tool follows the path, or set motion.gripper to parallel or suction"
        )
    if arm.model is not None and scene.carried is not None and not arm.has_gripper:
        raise UnusableInput(
            f"{arm.name} has no gripper that is known here, and scene {scene.name} has {scene.carried.name} to carry; "
            "plan in a scene without an object, where its tool follows the path, or mount teachpath's own gripper "
            "(teachpath arm add --gripper)"
        )


def check_home(settings: MotionSettings, arm: Arm) -> None:
    """Check that the home has an angle for each of the arm's joints, within its limits; raises UnusableSettings."""
    limits = arm.limits
    check_home_size(settings, arm)
    for name, angle, lower, upper in zip(limits.names, settings.home, limits.lower, limits.upper, strict=True):
        if not lower <= angle <= upper:
            raise UnusableSettings(f"motion.home puts {name} to {angle:.3f} rad, limits {lower:.3f} to {upper:.3f}")


def check_home_size(settings: MotionSettings, arm: Arm) -> None:
    """Check that the home has an angle for each of the arm's joints; raises UnusableSettings."""
    if len(settings.home) != arm.joint_count:
        raise UnusableSettings(
            f"setting motion.home has {len(settings.home)} angles, and the arm {arm.name} {arm.joint_count} joints"
        )


def with_home(settings: MotionSettings, arm: Arm) -> MotionSettings:
    """Return the settings with the home of a user's model in the middle of its joints' ranges, where none was said."""
    if arm.model is None or settings.home != MotionSettings().home:
        return settings
    middle = (arm.limits.lower + arm.limits.upper) / 2
    return replace(settings, home=tuple(float(angle) for angle in middle))
