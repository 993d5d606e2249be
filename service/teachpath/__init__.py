"""Teach a robot a path by showing it: the programming-by-demonstration service, and its parts for programs.

What is listed here is loaded when it is first used, so that the command line starts at once.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from teachpath.errors import (
        Cancelled,
        Conflict,
        LearningFailed,
        NotAllowed,
        NotFound,
        NotSignedIn,
        NotStopped,
        Outdated,
        OverLimit,
        PathRefused,
        QueueFull,
        StorageFull,
        StorageUnavailable,
        TeachpathError,
        TooManyAttempts,
        TooManyRequests,
        Unanswered,
        Unreachable,
        UnusableInput,
        UnusableRecording,
        UnusableSample,
        UnusableSettings,
    )
    from teachpath.io.arm_models.arm_reader import read_arm
    from teachpath.io.import_settings import ImportSettings
    from teachpath.io.readers.contract import FileMotions, OptionNeeded, Reader, ReadOptions, Track
    from teachpath.learning.settings import LearningSettings
    from teachpath.motion.arm.model import Arm
    from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
    from teachpath.motion.settings import MotionSettings
    from teachpath.nurbs import Curve
    from teachpath.python_api import learn, plan, setpoints
    from teachpath.records import Learned, LearnedPath, Plan, Scene, SerialArm, Shape, Trajectory

__version__ = "1.0.0"

__all__ = [
    "Arm",
    "Cancelled",
    "Conflict",
    "Curve",
    "FileMotions",
    "ImportSettings",
    "Learned",
    "LearnedPath",
    "LearningFailed",
    "LearningSettings",
    "MotionSettings",
    "NotAllowed",
    "NotFound",
    "NotSignedIn",
    "NotStopped",
    "OptionNeeded",
    "Outdated",
    "OverLimit",
    "PathRefused",
    "Plan",
    "QueueFull",
    "ReadOptions",
    "Reader",
    "Scene",
    "SerialArm",
    "Shape",
    "StorageFull",
    "StorageUnavailable",
    "TeachpathError",
    "TooManyAttempts",
    "TooManyRequests",
    "Track",
    "Trajectory",
    "Unanswered",
    "Unreachable",
    "UnusableInput",
    "UnusableRecording",
    "UnusableSample",
    "UnusableSettings",
    "empty_scene",
    "learn",
    "paper_scene",
    "plan",
    "read_arm",
    "setpoints",
]

_MODULES = {
    "Arm": "motion.arm.model",
    "LearningSettings": "learning.settings",
    "MotionSettings": "motion.settings",
    "empty_scene": "motion.collision.builtin_scenes",
    "paper_scene": "motion.collision.builtin_scenes",
    "Curve": "nurbs",
    "learn": "python_api",
    "plan": "python_api",
    "read_arm": "io.arm_models.arm_reader",
    "setpoints": "python_api",
    "ImportSettings": "io.import_settings",
} | dict.fromkeys(("FileMotions", "OptionNeeded", "ReadOptions", "Reader", "Track"), "io.readers.contract")
_MODULES |= dict.fromkeys(("Learned", "LearnedPath", "Plan", "Scene", "SerialArm", "Shape", "Trajectory"), "records")


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"module 'teachpath' has no attribute {name!r}")
    try:
        return getattr(import_module(f"teachpath.{_MODULES.get(name, 'errors')}"), name)
    except ModuleNotFoundError as missing:
        sentence = f"teachpath.{name} needs {missing.name}: pip install 'teachpath[service]'"
        raise ModuleNotFoundError(sentence, name=missing.name) from missing


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
