"""From a stream of hand samples to a demonstration: accounts, phases, the object's trajectory, the verdict. Pure."""

from teachpath.recording.account import StreamAccount
from teachpath.recording.coach import Shown, advise
from teachpath.recording.control import Control, Routine, State
from teachpath.recording.demonstration import (
    Pose,
    object_pose,
    object_trajectory,
    point_to_world,
    to_world,
    usable,
)
from teachpath.recording.frame import fit_frame
from teachpath.recording.gesture import FistGesture, Sign
from teachpath.recording.phases import GRASP_BUTTON, TOGGLE_BUTTON, Cut, Segmenter, closure_of
from teachpath.recording.positions import Faults, faults_of
from teachpath.recording.settings import RecordingSettings
from teachpath.recording.verdict import Verdict, judge, judge_again

__all__ = [
    "GRASP_BUTTON",
    "TOGGLE_BUTTON",
    "Control",
    "Cut",
    "Faults",
    "FistGesture",
    "Pose",
    "RecordingSettings",
    "Routine",
    "Segmenter",
    "Shown",
    "Sign",
    "State",
    "StreamAccount",
    "Verdict",
    "advise",
    "closure_of",
    "faults_of",
    "fit_frame",
    "judge",
    "judge_again",
    "object_pose",
    "object_trajectory",
    "point_to_world",
    "to_world",
    "usable",
]
