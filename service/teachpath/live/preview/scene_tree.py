"""The scene tree: what every viewer must show now, and the changes that each viewer has not received yet.

Commands are opaque bytes here. While a viewer has not acknowledged two batches, nothing is sent to it and its changes
are merged, so that a slow or sleeping page costs no memory and no time.
"""

from __future__ import annotations

import struct
import threading
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

MAX_UNACKNOWLEDGED = 2  # batches that are sent before the first of them must be acknowledged


def pack(commands: Iterable[bytes]) -> bytes:
    """Return one batch: `[u32 little-endian length][command]` of each."""
    return b"".join(struct.pack("<I", len(command)) + command for command in commands)


@dataclass
class Node:
    """The newest commands of one path: one object, one transform, one value per property."""

    content: bytes | None = None
    transform: bytes | None = None
    properties: dict[str, bytes] = field(default_factory=dict)


class Viewer:
    """One connected viewer: the changes that it has not been sent, one per path and kind."""

    def __init__(self, lock: threading.RLock, wake: Callable[[], None]) -> None:
        self._lock = lock
        self.wake: Callable[[], None] = wake
        self._ordered: dict[tuple[str, str], bytes] = {}  # objects, properties, deletes: in order of their last change
        self._transforms: dict[str, bytes] = {}
        self._unacknowledged = 0

    def pop(self) -> bytes | None:
        """Return the next batch, `[u32 little-endian length][command]...`, or None while there is none to send."""
        with self._lock:
            if self._unacknowledged >= MAX_UNACKNOWLEDGED or not (self._ordered or self._transforms):
                return None
            commands = [*self._ordered.values(), *self._transforms.values()]
            self._ordered.clear()
            self._transforms.clear()
            self._unacknowledged += 1
        return pack(commands)

    def acknowledge(self, batches: int = 1) -> None:
        """Take note that the viewer has drawn `batches` more batches."""
        with self._lock:
            self._unacknowledged = max(0, self._unacknowledged - max(0, batches))
        self.wake()

    @property
    def pending(self) -> int:
        """How many commands wait to be sent."""
        with self._lock:
            return len(self._ordered) + len(self._transforms)

    def _add(self, kind: str, path: str, command: bytes) -> None:
        if kind == "transform":
            self._transforms[path] = command
        else:
            self._ordered.pop((kind, path), None)
            self._ordered[kind, path] = command

    def _forget(self, path: str) -> None:
        self._ordered = {key: c for key, c in self._ordered.items() if not _within(key[1], path)}
        self._transforms = {key: c for key, c in self._transforms.items() if not _within(key, path)}


class SceneTree:
    """All that the view shows, kept in this process and replayed to every viewer that connects."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._nodes: dict[str, Node] = {}
        self._viewers: set[Viewer] = set()

    def connect(self, wake: Callable[[], None]) -> Viewer:
        """Add a viewer; its first batch is the whole tree. `wake()` is called, from any thread, when there is more."""
        with self._lock:
            viewer = Viewer(self._lock, wake)
            for kind, path, command in self._replay():
                viewer._add(kind, path, command)
            self._viewers.add(viewer)
        return viewer

    def disconnect(self, viewer: Viewer) -> None:
        """Forget a viewer."""
        with self._lock:
            self._viewers.discard(viewer)

    def __len__(self) -> int:
        return len(self._nodes)

    def paths(self, prefix: str = "/") -> list[str]:
        """Return the paths at and below `prefix` that hold an object."""
        with self._lock:
            return [p for p, node in self._nodes.items() if node.content is not None and _within(p, prefix)]

    def set_object(self, path: str, command: bytes) -> None:
        """Show an object at `path` instead of the one there."""
        with self._lock:
            self._node(path).content = command
            self._queue("object", path, command)
        self._wake()

    def set_transform(self, path: str, command: bytes) -> None:
        """Move what is at and below `path`; only the newest transform of a path is sent."""
        with self._lock:
            node = self._node(path)
            if node.transform != command:
                node.transform = command
                self._queue("transform", path, command)

    def set_property(self, path: str, name: str, command: bytes) -> None:
        """Set a property of `path`; one value is kept per property."""
        with self._lock:
            self._node(path).properties[name] = command
            self._queue("property " + name, path, command)
        self._wake()

    def delete(self, path: str, command: bytes) -> None:
        """Remove all at and below `path`, and all commands for it that were not sent yet."""
        with self._lock:
            gone = [p for p in self._nodes if _within(p, path)]
            if not gone:
                return
            for p in gone:
                del self._nodes[p]
            for viewer in self._viewers:
                viewer._forget(path)
            self._queue("delete", path, command)
        self._wake()

    def flush(self) -> None:
        """Wake the viewers after a set of transforms is complete."""
        self._wake()

    def _node(self, path: str) -> Node:
        return self._nodes.setdefault(path, Node())

    def _queue(self, kind: str, path: str, command: bytes) -> None:
        for viewer in self._viewers:
            viewer._add(kind, path, command)

    def _wake(self) -> None:
        with self._lock:
            viewers = list(self._viewers)
        for viewer in viewers:
            viewer.wake()

    def _replay(self) -> Iterator[tuple[str, str, bytes]]:
        for path in sorted(self._nodes, key=lambda p: (p.count("/"), p)):  # parents first
            node = self._nodes[path]
            if node.content is not None:
                yield "object", path, node.content
            if node.transform is not None:
                yield "transform", path, node.transform
            for name, command in node.properties.items():
                yield "property " + name, path, command


def _within(path: str, prefix: str) -> bool:
    return path == prefix or path.startswith(prefix.rstrip("/") + "/")
