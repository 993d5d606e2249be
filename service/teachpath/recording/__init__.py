"""From a stream of hand samples to a demonstration: accounts, phases, the object's trajectory, the verdict. Pure."""

from teachpath.recording.account import StreamAccount
from teachpath.recording.demonstration import judge, object_trajectory, to_world
from teachpath.recording.phases import GRASP_BUTTON, Cut, Segmenter
from teachpath.recording.settings import RecordingSettings

__all__ = [
    "GRASP_BUTTON",
    "Cut",
    "RecordingSettings",
    "Segmenter",
    "StreamAccount",
    "judge",
    "object_trajectory",
    "to_world",
]
