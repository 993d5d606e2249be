"""What a reader of recordings is, and what it returns; the members of `teachpath.readers` are instances of `Reader`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.records import Array, Trajectory

UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
TIME_UNITS = {"s": 1_000_000_000, "ms": 1_000_000, "us": 1000, "ns": 1}  # nanoseconds
QUATERNION_ORDERS = ("wxyz", "xyzw")

ReadOption = Literal["columns", "time", "track", "units"]

Integers = NDArray[np.int64]
Booleans = NDArray[np.bool_]


@dataclass(frozen=True)
class ReadOptions:
    """What the user says of a file; what is empty, the file or its format has to say.

    Attributes:
        units: of the positions, a key of UNITS.
        time_unit: a key of TIME_UNITS.
        rate: [Hz] of a format without a clock; 0: 50.
        columns: where text tables have what: `t=Time,x=Position.X,y=2`, names or numbers of columns from 1.
        quaternion: order of four columns that have no names, `wxyz` or `xyzw`.
        track: name of the one to read, of a file with several.
        joints: names of the joints of the station's arm, by which columns of joint angles are known.
    """

    units: str = ""
    time_unit: str = ""
    rate: float = 0.0
    columns: str = ""
    quaternion: str = ""
    track: str = ""
    joints: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class OpenQuestion:
    """What a file leaves open; the command line and the page each say in their words where to answer it.

    Attributes:
        problem: what is open, or wrong as it was read.
        option: that answers it.
        values: of the option that may be right; empty: any.
    """

    problem: str
    option: ReadOption
    values: tuple[str, ...] = ()


class OptionNeeded(UnusableRecording):
    """A file cannot be read as it was asked for; an option would mend it."""

    def __init__(self, problem: str, option: ReadOption, *values: str) -> None:
        super().__init__(problem, option, *values)  # which a process that reads files sends back
        self.question: OpenQuestion = OpenQuestion(problem, option, values)

    def __str__(self) -> str:
        """Return the problem and the option of the command line."""
        values = self.question.values
        *first, last = [*values[:MAX_NAMED], "another one"] if len(values) > MAX_NAMED else values or ("",)
        said = f" {', '.join(first)} or {last}" if first else f" {last}".rstrip()
        return f"{self.question.problem}; {WAYS_OUT[self.question.option]} --{self.question.option}{said}"


MAX_NAMED = 12  # values in a sentence
WAYS_OUT = {
    "columns": "say which is which with",
    "time": "say its unit with",
    "track": "choose one with",
    "units": "say their unit with",
}


@dataclass(frozen=True, eq=False)
class Track:
    """One recorded motion; rows in the order of the file.

    Attributes:
        stamps_ns: (n,) of the device's clock, whatever its epoch.
        positions: (n, 3) [m], in the file's frame; NaN where untracked.
        orientations: (n, 4) w, x, y, z or None.
        tracked: (n,) or None: every reading is a measurement.
        numbers: (n,) of the readings in the file, or None.
        closure: (n,) how far the hand is closed, 0 to 1, or None: the file does not tell.
        flexions: (n, 18 or 22) of a glove, 0 to 1, or None.
        joints: (n, joints) of the station's arm [rad], which showed the motion, or None.
    """

    stamps_ns: Integers
    positions: Array
    orientations: Array | None = None
    tracked: Booleans | None = None
    numbers: Integers | None = None
    closure: Array | None = None
    flexions: Array | None = None
    joints: Array | None = None

    @property
    def times(self) -> Array:
        """Times (n,) [s], from 0."""
        return np.asarray((self.stamps_ns - self.stamps_ns[:1]) * 1e-9)

    def trajectory(self) -> Trajectory:
        """Return the tracked readings, each time once, in the order of their times."""
        tracked = np.flatnonzero(np.ones(len(self.positions), np.bool_) if self.tracked is None else self.tracked)
        _, first = np.unique(self.stamps_ns[tracked], return_index=True)
        kept = tracked[first]
        times = (self.stamps_ns[kept] - self.stamps_ns[kept[0]]) * 1e-9
        return Trajectory(times, self.positions[kept], None if self.orientations is None else self.orientations[kept])


@dataclass(frozen=True, eq=False)
class JointTrack:
    """The recorded joint angles of an arm; where its tool was follows from the kinematics of the station's arm.

    Attributes:
        stamps_ns: (n,) of the device's clock, whatever its epoch.
        names: of the joints (k,), perhaps more than the arm has, in any order.
        angles: (n, k) [rad].
        closure: (n,) how far the gripper is closed, 0 to 1, or None: the file does not tell.
    """

    stamps_ns: Integers
    names: tuple[str, ...]
    angles: Array
    closure: Array | None = None


@dataclass(frozen=True, eq=False)
class FileMotions:
    """What a reader has found in a file.

    Attributes:
        tracks: the motions, each of which becomes a demonstration.
        understood: what was taken for time, units, orientation and frame, one phrase each.
        whole_motion: every motion is the transport alone, by the nature of the format.
        choices: what `ReadOptions.track` may name: bodies, markers or topics; empty: there is no choice.
        joint_tracks: angles instead of tracks; each that has all joints of the arm is a motion of its tool.
    """

    tracks: Sequence[Track]
    understood: tuple[str, ...] = ()
    whole_motion: bool = False
    choices: tuple[str, ...] = ()
    joint_tracks: Sequence[JointTrack] = ()


Progress = Callable[[float], None]


def _never(content: bytes, name: str) -> bool:
    return False


def unheard(share: float) -> None:
    """Tell nobody how far reading has come."""


@dataclass(frozen=True)
class Reader:
    """Reads one format.

    Attributes:
        name: of the format, as `--format` has it.
        title: of the format, for people.
        read: called with the content of a file, its name (for errors), the options and the limits. It raises
            UnusableRecording with a sentence that names the row, the value and the way out, or OptionNeeded.
        recognizes: tells whether content and name are certainly of this format.
        defaults: options of the format where neither the user nor the file says anything.
        read_file: likewise, called with a file of any size where it lies, and with what is told the share that was
            read; None: files of the format are taken into memory, and are limited.
    """

    name: str
    title: str
    read: Callable[[bytes, str, ReadOptions, ImportSettings], FileMotions]
    recognizes: Callable[[bytes, str], bool] = _never
    defaults: dict[str, Any] = field(default_factory=dict)
    read_file: Callable[[Path, str, ReadOptions, ImportSettings, Progress], FileMotions] | None = None
