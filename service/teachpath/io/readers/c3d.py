"""Marker trajectories in C3D, the binary form of motion capture."""

from __future__ import annotations

import io
import warnings
from typing import Any

import numpy as np

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.arrays import check_count, even_stamps
from teachpath.io.readers.columns import UNIT_NAMES
from teachpath.io.readers.contract import UNITS, FileMotions, OptionNeeded, Reader, ReadOptions, Track


def read_c3d(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read a marker of a C3D file; `options.track` chooses among several.

    Raises:
        UnusableRecording: it is damaged or over a limit; OptionNeeded: which marker is meant.
        UnusableInput: the library c3d is not installed.
    """
    try:
        import c3d
    except ModuleNotFoundError:
        raise UnusableInput(
            f"{name} is a C3D file, which needs c3d, which is not installed; install it with: pip install "
            "'teachpath[formats]'"
        ) from None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of what the library passes over, what matters is checked here
        reader = c3d.Reader(io.BytesIO(content))
        count = reader.last_frame - reader.first_frame + 1
        check_count(name, 1, count, limits)
        labels = [label.strip() for label in reader.point_labels][: reader.point_used]
        marker, rate = _chosen(labels, options.track, name), float(reader.point_rate)
        if not 1.0 <= rate <= 10_000.0:
            raise UnusableRecording(f"{name}: its rate of {rate:g} Hz is outside 1 to 10000")
        points = _points(reader, marker)
    if len(points) < count:
        raise UnusableRecording(f"{name}: it is cut off: {len(points)} of {count} frames are in it")
    length = options.units or _unit(reader) or "m"
    tracked = points[:, 3] >= 0.0
    positions = np.where(tracked[:, None], points[:, :3] * UNITS[length], np.nan)
    track = Track(even_stamps(count, rate), positions, tracked=tracked, numbers=np.arange(count) + reader.first_frame)
    understood = (f"marker {labels[marker]}", f"{rate:g} Hz", f"position in {length}", "no orientation")
    return FileMotions([track], understood, choices=tuple(labels) if len(labels) > 1 else ())


def _points(reader: Any, marker: int) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return x, y, z and the residual (n, 4) of a marker; a residual below 0 says that it was not seen."""
    rows = [points[marker, :4].astype(np.float64) for _, points, _ in reader.read_frames(copy=False)]
    return np.array(rows).reshape(-1, 4)


def _chosen(labels: list[str], wanted: str, name: str) -> int:
    if not labels:
        raise UnusableRecording(f"{name}: it holds no markers")
    if wanted and wanted not in labels:
        raise OptionNeeded(f"{name}: no {wanted!r} in it", "track", *labels)
    if len(labels) > 1 and not wanted:
        raise OptionNeeded(f"{name}: it holds {len(labels)} markers", "track", *labels)
    return labels.index(wanted) if wanted else 0


def _unit(reader: Any) -> str:
    stated = reader.get("POINT:UNITS")
    unit = UNIT_NAMES.get(stated.string_value.strip().lower(), "") if stated is not None else ""
    return unit if unit in UNITS else ""


C3D = Reader("c3d", "marker trajectories (C3D)", read_c3d, lambda content, name: name.endswith(".c3d"))
