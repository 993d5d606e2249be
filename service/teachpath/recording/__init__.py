"""From a stream of hand samples to a demonstration: accounts, phases, the object's trajectory, the verdict. Pure."""

from teachpath.recording.account import StreamAccount
from teachpath.recording.coach import Shown, advise
from teachpath.recording.demonstration import object_trajectory, point_to_world, to_world, usable
from teachpath.recording.frame import fit_frame
from teachpath.recording.phases import GRASP_BUTTON, TOGGLE_BUTTON, Cut, Segmenter
from teachpath.recording.positions import Faults, faults_of
from teachpath.recording.settings import RecordingSettings
from teachpath.recording.verdict import Verdict, judge

__all__ = [
    "GRASP_BUTTON",
    "TOGGLE_BUTTON",
    "Cut",
    "Faults",
    "RecordingSettings",
    "Segmenter",
    "Shown",
    "StreamAccount",
    "Verdict",
    "advise",
    "faults_of",
    "fit_frame",
    "judge",
    "object_trajectory",
    "point_to_world",
    "to_world",
    "usable",
]
