"""The motion room: from a learned path to a certified plan, and the arm along it, live."""

from teachpath.motion.assessment import assess
from teachpath.motion.certificate import verify
from teachpath.motion.drawing import Part, drawing
from teachpath.motion.mjcf import mjcf
from teachpath.motion.plan import plan
from teachpath.motion.scenes import empty_scene, paper_scene, scenes
from teachpath.motion.settings import MotionSettings

__all__ = [
    "MotionSettings",
    "Part",
    "assess",
    "drawing",
    "empty_scene",
    "mjcf",
    "paper_scene",
    "plan",
    "scenes",
    "verify",
]
