"""MAT files of MATLAB: named arrays, as in npz, with time along their rows or their columns."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.arrays import NAMES, named_motion
from teachpath.io.readers.contract import FileMotions, Reader, ReadOptions
from teachpath.io.readers.hdf5 import root_arrays

HEAD, HDF5_HEAD = b"MATLAB 5.0 MAT-file", b"MATLAB 7.3 MAT-file"
NUMBER_SIZE = 8  # bytes of a number of MATLAB's usual type
KNOWN_NAMES = frozenset(key for keys in NAMES.values() for key in keys)
WIDTHS: Mapping[str, int] = {"positions": 3, "orientations": 4}  # numbers in a row


def read_mat(content: bytes, name: str, options: ReadOptions, limits: ImportSettings) -> FileMotions:
    """Read arrays named as in npz: t, positions, perhaps orientations, tracked and grasp, or poses (4, 4, n).

    Raises:
        UnusableRecording: it holds no positions, or more than the limits allow.
        UnusableInput: it is of version 7.3, and h5py is not installed.
    """
    if content.startswith(HDF5_HEAD):  # whose arrays lie the other way round
        arrays = {key: array.T for key, array in root_arrays(content, name, limits).items()}
    else:
        arrays = _arrays(content, name, limits)
    found = {key: _by_rows(role, arrays[key]) for role, keys in NAMES.items() for key in keys if key in arrays}
    return named_motion(found, name, options)


def _arrays(content: bytes, name: str, limits: ImportSettings) -> dict[str, NDArray[Any]]:
    from scipy.io import loadmat, whosmat

    held = whosmat(io.BytesIO(content))  # type: ignore[arg-type]  # the stubs know files by name only
    size = sum(math.prod(shape) for key, shape, _ in held if key in KNOWN_NAMES) * NUMBER_SIZE
    if size > limits.max_expanded_size:
        raise UnusableRecording(
            f"{name}: its arrays expand to {size} bytes, limit {limits.max_expanded_size} "
            "(imports.max_expanded_size); split the file"
        )
    wanted = [key for key, _, _ in held if key in KNOWN_NAMES]
    loaded = loadmat(io.BytesIO(content), variable_names=wanted)  # type: ignore[arg-type]
    arrays = {key: value for key, value in loaded.items() if key in KNOWN_NAMES and isinstance(value, np.ndarray)}
    usable = {key: value for key, value in arrays.items() if value.dtype.kind in "fiub"}
    if not usable:
        names = ", ".join(f"{key} ({kind})" for key, _, kind in held[:12]) or "nothing"
        raise UnusableRecording(f"{name}: no array positions (n, 3) in it; it holds {names}")
    return usable


def _by_rows(role: str, array: NDArray[Any]) -> NDArray[Any]:
    """Return an array with time along its first axis: MATLAB's vectors have two axes, its lists of poses end in n."""
    if role == "matrices":
        last = array.ndim == 3 and array.shape[:2] == (4, 4)
        return np.moveaxis(array, 2, 0) if last else array[None] if array.shape == (4, 4) else array
    if role in WIDTHS:
        lying = array.ndim == 2 and array.shape[0] == WIDTHS[role] != array.shape[1]
        return array.T if lying else array
    return array.reshape(-1) if array.ndim == 2 and 1 in array.shape else array


MATLAB = Reader(
    "mat",
    "arrays of MATLAB",
    read_mat,
    lambda content, name: content.startswith((HEAD, HDF5_HEAD)) or name.endswith(".mat"),
)
