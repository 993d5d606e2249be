"""The arm that the settings name: its model is read from what the station keeps."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

from teachpath.config import Settings
from teachpath.errors import NotFound, UnusableSettings
from teachpath.io.store.arms import Arms
from teachpath.io.store.store import Store
from teachpath.motion.planning.model_arms import check_home
from teachpath.motion.settings import MotionSettings

# Settings that describe the Puma 560 and what it carries; a model has its own.
PUMA_SETTINGS: Final = ("variant", "tool_length", "tool_position", "tool_orientation", "payload_mass")


def with_stored_arm(settings: Settings, arms: Arms) -> Settings:
    """Return the settings with the newest version of the arm that `motion.arm` names.

    Raises:
        UnusableSettings: there is none of that name, its home is outside its limits, or the settings describe a
            tool or payload beside it.
    """
    name, default = settings.motion.arm, MotionSettings()
    if name is None:
        return settings
    for setting in PUMA_SETTINGS:
        if (value := getattr(settings.motion, setting)) != getattr(default, setting):
            raise UnusableSettings(
                f"setting motion.{setting} is {value!r}, and motion.arm is {name!r}: leave out the one that does not "
                "count; tool, gripper and payload of such an arm are given when it is added (teachpath arm add)"
            )
    try:
        model = arms.versions(name)[0].arm
    except NotFound:
        kept = ", ".join(stored.arm.name for stored in arms.newest()) or "none"
        raise UnusableSettings(
            f"setting motion.arm is {name!r}, and no arm of that name is kept (kept: {kept}); add it with: teachpath "
            f"arm add {name} MODEL"
        ) from None
    found = settings.with_model(model)
    check_home(found.motion, found.arm)
    return found


def open_store(settings: Settings, changed: Callable[..., None]) -> tuple[Store, Settings]:
    """Open a station's store, and return it with the settings and the model of the arm that they name.

    Args:
        settings: of the station.
        changed: called with every row that has changed.

    Raises:
        UnusableSettings: see `with_stored_arm`.
    """
    store = Store(settings.store, changed=changed)
    try:
        return store, with_stored_arm(settings, store.arms)
    except BaseException:
        store.close()
        raise
