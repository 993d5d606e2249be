"""What lasts: rows of tasks, demonstrations, runs, paths, plans and jobs, and the recordings beside them."""

from teachpath.io.store.motions import Motion, MotionHeader, Motions, MotionTake, read_motion
from teachpath.io.store.recordings import RecordingHeader, Recordings, Take
from teachpath.io.store.store import ExecutionRow, RunRow, Store, StoreSettings
from teachpath.io.store.versions import Edit, Versions

__all__ = [
    "Edit",
    "ExecutionRow",
    "Motion",
    "MotionHeader",
    "MotionTake",
    "Motions",
    "RecordingHeader",
    "Recordings",
    "RunRow",
    "Store",
    "StoreSettings",
    "Take",
    "Versions",
    "read_motion",
]
