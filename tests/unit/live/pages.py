"""What a page is told, unpacked, for tests."""

import struct
from typing import Any

import umsgpack

from teachpath.live.preview.scene_tree import Viewer


def ignore() -> None:
    """Wake nobody."""


def split(batch: bytes | None) -> list[bytes]:
    found, at = [], 0
    while batch and at < len(batch):
        (length,) = struct.unpack_from("<I", batch, at)
        found.append(batch[at + 4 : at + 4 + length])
        at += 4 + length
    return found


def decoded(batch: bytes | None) -> list[dict[str, Any]]:
    return [umsgpack.unpackb(command) for command in split(batch)]


def take(viewer: Viewer) -> list[dict[str, Any]]:
    batch = viewer.pop()
    viewer.acknowledge()
    return decoded(batch)
