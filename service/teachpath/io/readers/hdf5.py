"""HDF5: demonstrations of robomimic, and files of named arrays, as in npz; MAT files of MATLAB 7.3 are HDF5, too."""

from __future__ import annotations

import io
import json
import math
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.arrays import NAMES, RATE, check_count, even_stamps, named_motion
from teachpath.io.readers.contract import UNITS, FileMotions, OptionNeeded, Progress, Reader, ReadOptions, Track

MAGIC: Final = b"\x89HDF\r\n\x1a\n"
DEMONSTRATION: Final = re.compile(r"demo_(\d{1,9})")
POSITION, ORIENTATION = "_eef_pos", "_eef_quat"  # end the names of what robosuite observes of an arm's hand
ACTION_WIDTH: Final = 7  # numbers of an arm's action: six of the hand's motion, and the gripper's, which closes above 0
MAX_NAMED: Final = 12  # in a sentence


def read_hdf5(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read the demonstrations of robomimic; where there are none, arrays named as in npz.

    Raises:
        UnusableRecording: it holds neither, or more than the limits allow; OptionNeeded: which arm is meant.
        UnusableInput: h5py is not installed.
    """
    return _motions(io.BytesIO(content), name, options, limits)


def read_hdf5_file(
    file: Path, name: str, options: ReadOptions, limits: ImportSettings, progress: Progress
) -> FileMotions:
    """Read a file of any size, of which pictures are not read; likewise."""
    progress(0.0)
    return _motions(file, name, options, limits)


def _motions(source: BinaryIO | Path, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    with _opened(source, name) as file:
        data = _member(file, "data", name)
        if data is not None and not _is_array(data):
            return _robomimic(data, name, options, limits)
        return named_motion(_root_arrays(file, name, limits), name, options)


def root_arrays(content: bytes, name: str, limits: ImportSettings) -> dict[str, NDArray[Any]]:
    """Return the arrays at the root of a file that may be part of a motion; raises as `read_hdf5`."""
    with _opened(io.BytesIO(content), name) as file:
        return _root_arrays(file, name, limits)


def _root_arrays(file: Any, name: str, limits: ImportSettings) -> dict[str, NDArray[Any]]:
    wanted = {key for keys in NAMES.values() for key in keys}
    members = {key: _member(file, key, name) for key in file if key in wanted}
    arrays = {key: found for key, found in members.items() if _is_array(found) and found.dtype.kind in "fiub"}
    if not arrays:
        raise UnusableRecording(
            f"{name}: neither demonstrations of robomimic (data/demo_0) nor arrays positions and t in it; it holds "
            f"{', '.join(list(file)[:MAX_NAMED]) or 'nothing'}"
        )
    _check_size(arrays.values(), name, limits)
    return {key: np.asarray(array[...]) for key, array in arrays.items()}


def _robomimic(data: Any, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    numbered = {int(found[1]): key for key in data if (found := DEMONSTRATION.fullmatch(str(key)))}
    if not numbered:
        raise UnusableRecording(f"{name}: no demonstration data/demo_0 in it; data holds {list(data)[:MAX_NAMED]}")
    demonstrations = [_member(data, numbered[number], name) for number in sorted(numbered)]
    observed = [_member(each, "obs", name) for each in demonstrations]
    arms = [key.removesuffix(POSITION) for key in observed[0] or () if key.endswith(POSITION)]
    arm = _chosen(arms, options.track, name)
    places = [_array(obs, arm + POSITION, 3, name) for obs in observed]
    check_count(name, len(places), sum(len(place) for place in places), limits)
    turns = [_member(obs, arm + ORIENTATION, name) and _array(obs, arm + ORIENTATION, 4, name) for obs in observed]
    grippers = [
        _gripper(each, ACTION_WIDTH * arms.index(arm), len(place), name)
        for each, place in zip(demonstrations, places, strict=True)
    ]
    _check_size([*places, *(turn for turn in turns if turn is not None)], name, limits)
    rate, source = _rate(data, options)
    order, length = options.quaternion or "xyzw", options.units or "m"
    tracks = [
        Track(
            even_stamps(len(place), rate),
            np.asarray(place[...], np.float64) * UNITS[length],
            None if turn is None else np.asarray(turn[...], np.float64)[:, _to_wxyz(order)],
            closure=closed,
        )
        for place, turn, closed in zip(places, turns, grippers, strict=True)
    ]
    understood = (
        f"{len(tracks)} demonstrations of robomimic",
        f"{rate:g} Hz, {source}",
        f"position in {length} ({arm}{POSITION})",
        f"quaternion {', '.join(order)}" if tracks[0].orientations is not None else "no orientation",
        "grasp from the gripper's action" if tracks[0].closure is not None else "no grasp",
    )
    return FileMotions(tracks, understood, choices=tuple(arms) if len(arms) > 1 else ())


def _to_wxyz(order: str) -> list[int]:
    return [3, 0, 1, 2] if order == "xyzw" else [0, 1, 2, 3]


def _gripper(demonstration: Any, begin: int, count: int, name: str) -> NDArray[np.float64] | None:
    """Return whether an arm's gripper was told to close (count,), 0 or 1; None where the actions are others."""
    actions = _member(demonstration, "actions", name)
    if not _is_array(actions) or actions.dtype.kind != "f" or actions.ndim != 2 or len(actions) != count:
        return None
    gripper, width = begin + ACTION_WIDTH - 1, actions.shape[1]
    return None if gripper >= width or width % ACTION_WIDTH else (actions[:, gripper] > 0.0).astype(np.float64)


def _array(group: Any, key: str, width: int, name: str) -> Any:
    """Return an array (n, width) of numbers, unread."""
    array = _member(group, key, name)
    if not _is_array(array) or array.dtype.kind not in "fiu" or array.ndim != 2 or array.shape[1] != width:
        kind = f"{array.dtype} {array.shape}" if _is_array(array) else "no array"
        raise UnusableRecording(f"{name}: {key} is {kind}; it must be numbers (n, {width})")
    return array


def _chosen(arms: list[str], wanted: str, name: str) -> str:
    if not arms:
        raise UnusableRecording(
            f"{name}: no position of a hand in it (obs/robot0{POSITION}); joints alone are not read"
        )
    if wanted and wanted not in arms:
        raise OptionNeeded(f"{name}: no {wanted!r} in it", "track", *arms)
    if len(arms) > 1 and not wanted:
        raise OptionNeeded(f"{name}: it holds {len(arms)} arms", "track", *arms)
    return wanted or arms[0]


def _rate(data: Any, options: ReadOptions) -> tuple[float, str]:
    """Return the rate [Hz] and where it is from: files of robomimic have no clock."""
    if options.rate:
        return options.rate, "as said"
    try:
        rate = float(json.loads(data.attrs["env_args"])["env_kwargs"]["control_freq"])
    except (KeyError, TypeError, ValueError):
        rate = 0.0
    return (rate, "by its env_args") if 1.0 <= rate <= 10_000.0 else (RATE, "it has no clock")


def _check_size(arrays: Iterable[Any], name: str, limits: ImportSettings) -> None:
    size = sum(math.prod(array.shape) * array.dtype.itemsize for array in arrays)
    if size > limits.max_expanded_size:
        raise UnusableRecording(
            f"{name}: its arrays expand to {size} bytes, limit {limits.max_expanded_size} "
            "(imports.max_expanded_size); split the file"
        )


@contextmanager
def _opened(source: BinaryIO | Path, name: str) -> Iterator[Any]:
    try:
        import h5py
    except ModuleNotFoundError:
        raise UnusableInput(
            f"{name} is an HDF5 file, which needs h5py, which is not installed; install it with: pip install "
            "'teachpath[formats]'"
        ) from None
    with h5py.File(source, "r") as file:
        yield file


def _member(group: Any, key: str, name: str) -> Any:
    """Return a group or an array of a group; None: there is none.

    A file may refer to others on the disk of whoever opens it; what is not in the file itself is refused.
    """
    import h5py

    if not isinstance(group, h5py.Group) or key not in group:
        return None
    if not isinstance(group.get(key, getlink=True), h5py.HardLink):
        raise UnusableRecording(f"{name}: {key} is a link to another place; write the file anew with what it links to")
    member = group[key]
    if isinstance(member, h5py.Dataset) and (member.external or member.is_virtual):
        raise UnusableRecording(f"{name}: {key} lies in another file; write it anew with all that it holds")
    return member


def _is_array(member: Any) -> bool:
    return hasattr(member, "dtype") and hasattr(member, "shape")


HDF5 = Reader(
    "hdf5",
    "HDF5: demonstrations of robomimic, or named arrays",
    read_hdf5,
    lambda content, name: content.startswith(MAGIC),
    read_file=read_hdf5_file,
)
