"""Arrays: .npy of rows or motions, .npz of named arrays, RoboTasks, and texts of 4x4 matrices."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import (
    TIME_UNITS,
    UNITS,
    FileMotions,
    Integers,
    OptionNeeded,
    Reader,
    ReadOptions,
    Track,
)
from teachpath.io.readers.text import numbered_lines
from teachpath.io.readers.time_units import time_unit
from teachpath.records import Array

RATE = 50.0  # [Hz] of a format without a clock, unless said
ORTHOGONAL = 0.02  # by which the columns of a rotation matrix may miss length 1 and right angles
NAMES: Mapping[str, tuple[str, ...]] = {
    "t": ("t", "time", "times", "timestamp", "timestamps", "stamps"),
    "positions": ("positions", "position", "pos", "xyz", "p", "translation", "translations"),
    "orientations": ("orientations", "orientation", "quaternions", "quaternion", "quat", "q", "rot", "rotations"),
    "tracked": ("tracked", "valid"),
    "grasp": ("grasp", "grasped", "closed", "flexion", "closure"),
    "matrices": ("matrices", "poses", "pose", "transforms", "T"),
}


def check_count(name: str, motions: int, samples: int, limits: ImportSettings) -> None:
    """Raise UnusableRecording when a file holds more motions or samples than the limits allow."""
    if motions > limits.max_motions:
        raise UnusableRecording(
            f"{name}: {motions} motions, limit {limits.max_motions} (imports.max_motions); split the file"
        )
    if samples > limits.max_samples:
        raise UnusableRecording(
            f"{name}: {samples} samples, limit {limits.max_samples} (imports.max_samples); split the file"
        )


def read_npy(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read an array of rows t, x, y, z, perhaps with a quaternion, or of several such motions."""
    values = _motions(content, name, limits, columns=(4, 8), single=True)
    length, turned = options.units or "m", values.shape[2] == 8
    unit = time_unit(values[0, :, 0], said=options.time_unit, stated="", name=name)
    tracks = [
        Track(
            _stamps(v[:, 0], unit, name), v[:, 1:4] * UNITS[length], _quaternions(v[:, 4:], options) if turned else None
        )
        for v in values
    ]
    return FileMotions(
        tracks, (f"time in {unit}", f"position in {length}", _order(options) if turned else "no orientation")
    )


def read_robottasks(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read kinesthetic demonstrations: motions of x, y, z [cm], w, x, y, z without a clock."""
    values = _motions(content, name, limits, columns=(7,), single=False)
    length, rate = options.units or "cm", options.rate or RATE
    stamps = even_stamps(values.shape[1], rate)
    tracks = [Track(stamps, v[:, :3] * UNITS[length], _quaternions(v[:, 3:], options)) for v in values]
    understood = (f"{rate:g} Hz, it has no clock", f"position in {length}", _order(options))
    return FileMotions(tracks, understood, whole_motion=True)


def read_npz(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read named arrays: t (n,), positions (n, 3), perhaps orientations (n, 4), tracked and grasp (n,)."""
    return named_motion(_load_archive(content, name, limits), name, options)


def named_motion(arrays: Mapping[str, NDArray[Any]], name: str, options: ReadOptions) -> FileMotions:
    """Return the motion that arrays hold, which `NAMES` tells apart.

    Raises:
        UnusableRecording: there are no positions, or an array is not of their length.
    """
    found = {role: next((arrays[key] for key in keys if key in arrays), None) for role, keys in NAMES.items()}
    if found["matrices"] is not None and found["positions"] is None:
        found["positions"], found["orientations"] = _poses(found["matrices"], name)
        options = ReadOptions(options.units, options.time_unit, options.rate)
    positions, times = found["positions"], found["t"]
    if positions is None or positions.ndim != 2 or positions.shape[1] != 3 or not len(positions):
        raise UnusableRecording(
            f"{name}: no array positions (n, 3) in it; it holds {', '.join(sorted(arrays)) or 'none'}"
        )
    wanted = {
        "t": (len(positions),),
        "orientations": (len(positions), 4),
        "tracked": (len(positions),),
        "grasp": (len(positions),),
    }
    for role, shape in wanted.items():
        array = found[role]
        if array is not None and array.shape != shape:
            raise UnusableRecording(f"{name}: {role} is {array.shape}; beside the positions it must be {shape}")
    length, turned = options.units or "m", found["orientations"]
    if times is None:
        stamps, clock = (
            even_stamps(len(positions), options.rate or RATE),
            f"{options.rate or RATE:g} Hz, it has no clock",
        )
    else:
        unit = time_unit(np.asarray(times, np.float64), said=options.time_unit, stated="", name=name)
        stamps, clock = _stamps(times, unit, name), f"time in {unit}"
    track = Track(
        stamps,
        positions * UNITS[length],
        None if turned is None else _quaternions(turned, options),
        None if found["tracked"] is None else found["tracked"] > 0.5,
        None,
        None if found["grasp"] is None else np.asarray(found["grasp"], np.float64),
    )
    return FileMotions(
        [track], (clock, f"position in {length}", "no orientation" if turned is None else _order(options))
    )


def read_matrices(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read homogeneous 4x4 matrices as text, one after another, without a clock."""
    lines = numbered_lines(content, name, limits)
    check_count(name, 1, len(lines) // 4, limits)
    try:
        rows = [[float(cell) for cell in line.replace(",", " ").split()] for _, line in lines]
    except ValueError as error:
        raise UnusableRecording(f"{name}: {error}; it must hold matrices of four rows of four numbers") from None
    bad = next((line for (line, _), row in zip(lines, rows, strict=True) if len(row) != 4), None)
    if bad is not None or len(rows) % 4 or not rows:
        where = f"line {bad}" if bad is not None else f"{len(rows)} rows"
        raise UnusableRecording(f"{name}, {where}: matrices have four rows of four numbers; is the file truncated?")
    positions, orientations = _poses(np.array(rows).reshape(-1, 4, 4), name)
    length, rate = options.units or "m", options.rate or RATE
    track = Track(even_stamps(len(positions), rate), positions * UNITS[length], orientations)
    return FileMotions([track], (f"{rate:g} Hz, it has no clock", f"position in {length}", "orientation from matrices"))


def _poses(matrices: Array, name: str) -> tuple[Array, Array]:
    if matrices.ndim != 3 or matrices.shape[1:] != (4, 4):
        raise UnusableRecording(f"{name}: poses must be (n, 4, 4); they are {matrices.shape}")
    turns = matrices[:, :3, :3]
    with np.errstate(all="ignore"):
        off = np.abs(turns @ turns.transpose(0, 2, 1) - np.eye(3)).max(axis=(1, 2))
        right = (off < ORTHOGONAL) & (np.linalg.det(turns) > 0.0)
        right &= np.all(np.abs(matrices[:, 3] - [0.0, 0.0, 0.0, 1.0]) < 1e-6, axis=1)
    if not right.all():
        k = int(np.argmin(right))
        raise UnusableRecording(f"{name}: matrix {k} is no rotation with a translation in its last column")
    return matrices[:, :3, 3], np.asarray(Rotation.from_matrix(turns).as_quat(scalar_first=True))


def _motions(
    content: bytes, name: str, limits: ImportSettings, *, columns: tuple[int, ...], single: bool
) -> NDArray[np.float64]:
    values = load_array(io.BytesIO(content), len(content), name, limits)
    is_array = values.dtype.kind == "f"
    if is_array and single and values.ndim == 2:
        values = values[None]
    if not is_array or values.ndim != 3 or values.shape[2] not in columns:
        wanted = " or ".join(map(str, columns))
        raise UnusableRecording(f"{name}: the array must be floats (motions, samples, {wanted}); it is {values.shape}")
    if len(values) == 0 or values.shape[1] == 0:
        raise UnusableRecording(f"{name}: the array holds no demonstrations")
    return values.astype(np.float64)


def load_array(stream: BinaryIO, size: int, name: str, limits: ImportSettings) -> NDArray[Any]:
    """Return the array of an .npy file; what its header states is checked before memory is taken for it."""
    version = np.lib.format.read_magic(stream)
    read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, dtype = read_header(stream)
    if dtype.hasobject:
        raise UnusableRecording(f"{name}: not a whole .npy array of numbers: it holds Python objects")
    check_count(name, shape[0] if len(shape) == 3 and shape[1:] != (4, 4) else 1, _rows_of(shape), limits)
    if math.prod(shape) * dtype.itemsize != size - stream.tell():
        raise UnusableRecording(
            f"{name}: not a whole .npy array of numbers: {shape} of {dtype} is not what {size - stream.tell()} bytes "
            "hold"
        )
    stream.seek(0)
    loaded: NDArray[Any] = np.load(stream, allow_pickle=False)
    return loaded


def _rows_of(shape: tuple[int, ...]) -> int:
    return shape[0] if shape[1:] == (4, 4) else math.prod(shape[:-1])


def _load_archive(content: bytes, name: str, limits: ImportSettings) -> dict[str, NDArray[Any]]:
    arrays: dict[str, NDArray[Any]] = {}
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        members = [info for info in archive.infolist() if info.filename.endswith(".npy")]
        expanded = sum(info.file_size for info in members)
        if expanded > limits.max_expanded_size:
            raise UnusableRecording(
                f"{name}: its arrays expand to {expanded} bytes, limit {limits.max_expanded_size} "
                "(imports.max_expanded_size); split the file"
            )
        for info in members:
            with archive.open(info) as packed:
                data = packed.read(info.file_size + 1)
            array = load_array(io.BytesIO(data), len(data), f"{name}, {info.filename}", limits)
            if array.dtype.kind in "fiub":
                arrays[info.filename.removesuffix(".npy")] = array
    return arrays


def even_stamps(count: int, rate: float) -> Integers:
    """Return the stamps (count,) [ns] of readings at a rate [Hz], from 0."""
    return np.round(np.arange(count) * (1e9 / rate)).astype(np.int64)


def _stamps(times: NDArray[Any], unit: str, name: str) -> Integers:
    if not np.isfinite(times).all():
        raise UnusableRecording(f"{name}: sample {int(np.argmin(np.isfinite(times)))} has a t that is not finite")
    if times.dtype.kind in "iu" and int(np.abs(times).max()) < 2**62 // TIME_UNITS[unit]:
        return times.astype(np.int64) * TIME_UNITS[unit]
    stamps = np.asarray(times, np.float64) * TIME_UNITS[unit]
    if np.abs(stamps).max() >= 2.0**62:
        raise OptionNeeded(f"{name}: a time of {float(np.abs(stamps).max()) * 1e-9:g} s is no time", "time")
    return np.round(stamps).astype(np.int64)


def _quaternions(values: Array, options: ReadOptions) -> Array:
    ordered = values[:, [3, 0, 1, 2]] if options.quaternion == "xyzw" else values
    return np.asarray(ordered, np.float64)


def _order(options: ReadOptions) -> str:
    return f"quaternion {', '.join(options.quaternion or 'wxyz')}"


NPY = Reader("npy", "array of t, x, y, z[, quaternion]", read_npy, lambda content, name: content[:6] == b"\x93NUMPY")
NPZ = Reader("npz", "named arrays", read_npz, lambda content, name: name.endswith(".npz") and content[:2] == b"PK")
ROBOTTASKS = Reader("robottasks", "RoboTasks: motions of x, y, z [cm], quaternion", read_robottasks)
MATRICES = Reader(
    "matrices",
    "4x4 matrices as text",
    read_matrices,
    lambda content, name: name.endswith(".traj") or _is_matrix(content[:1000]),
)


def _is_matrix(beginning: bytes) -> bool:
    lines = [line.replace(b",", b" ").split() for line in beginning.splitlines() if line.strip()][:4]
    try:
        rows = [[float(cell) for cell in line] for line in lines]
    except ValueError:
        return False
    return len(rows) == 4 and all(len(row) == 4 for row in rows) and rows[3] == [0.0, 0.0, 0.0, 1.0]
