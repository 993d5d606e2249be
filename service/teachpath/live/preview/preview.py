"""The running preview: one thread that draws arm, object and hands as the bus reports them."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from types import TracebackType

import numpy as np

from teachpath.errors import UnusableInput
from teachpath.io.bus import Bus, Handle
from teachpath.io.wire import decode_state
from teachpath.live.preview import commands
from teachpath.live.preview.scene_tree import SceneTree, Viewer
from teachpath.live.preview.settings import PreviewSettings
from teachpath.motion.arm.geometry import LinkSolid
from teachpath.motion.arm.kinematics import link_frames
from teachpath.motion.arm.model import Arm
from teachpath.periodic_thread import PeriodicThread
from teachpath.records import Array, HandState, Phase, RecordingStatus, Shape, Vector
from teachpath_proto.keys import Keys

OPEN_HAND_COLOR, CLOSED_HAND_COLOR = 0x3F7FBF, 0xE08A00
MARKER_RADIUS = 0.016  # [m]


@dataclass
class _HandDrawing:
    """A hand as it is drawn now."""

    trail: deque[Vector]
    last_sample: float  # [s] when its newest sample was seen
    received: int = -1
    take: int = 0
    is_closed: bool | None = None
    has_object: bool = False
    trail_drawn: float = field(default=-np.inf)  # [s] when


class Preview:
    """Draws for every connected viewer; start it, or use it as a context manager."""

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        drawing: Sequence[LinkSolid],
        *,
        arm: Arm,
        robot: str,
        home: Array,
        statuses: Callable[[], Iterable[RecordingStatus]],
        settings: PreviewSettings | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare the view; nothing runs before `start`.

        Args:
            drawing: the primitives of the arm, each in the frame of its link.
            arm: whose links they are.
            robot: name of the arm whose joint states are drawn.
            home: (joints,) configuration shown until the first joint state comes [rad].
            statuses: returns the recordings whose hands are drawn, with their hands.
            clock: [s] monotonic.
        """
        self._bus = bus
        self._keys = keys
        self._robot = robot
        self._arm = arm
        self._statuses = statuses
        self._clock = clock
        self._settings = settings or PreviewSettings()
        self._tree = SceneTree()
        self._state: bytes | None = None
        self._hands: dict[str, _HandDrawing] = {}  # by tracker
        self._object: Shape | None = None
        self._handles: list[Handle] = []
        self._thread = PeriodicThread("preview", 1.0 / self._settings.rate, self.update)
        self._fingers: list[tuple[str, Array]] = []
        for part in drawing:
            self._put_part(part)
        self._pose_arm(home, gripper_closed=False)

    def start(self) -> None:
        """Follow the bus from now on."""
        self._handles = [self._bus.subscribe(self._keys.state(self._robot), self._receive_state)]
        self._thread.start()

    def stop(self) -> None:
        """Stop following; a second call does nothing."""
        for handle in self._handles:
            handle.close()
        self._handles.clear()
        self._thread.stop()

    def __enter__(self) -> Preview:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()

    def connect(self, wake: Callable[[], None]) -> Viewer:
        """Add a viewer; its `pop()` returns what to send, and `wake()` is called, from any thread, when there is more.

        The first batch draws all that is shown now.
        """
        return self._tree.connect(wake)

    def disconnect(self, viewer: Viewer) -> None:
        """Forget a viewer that has gone."""
        self._tree.disconnect(viewer)

    def paths(self, prefix: str = "/") -> list[str]:
        """Return the paths in the tree, at and below `prefix`, that hold an object."""
        return self._tree.paths(prefix)

    def show_object(self, carried: Shape | None) -> None:
        """Show this object at its start instead of the one shown before; None: show none."""
        self.clear("/object")
        self._object = carried
        if carried is not None:
            body = commands.solid("/object", carried.kind, carried.size, color=carried.color, vertices=carried.vertices)
            self._tree.set_object("/object", body)
            self._place_at_start(carried)
            self._tree.flush()

    def clear(self, prefix: str) -> None:
        """Remove all at and below `prefix`, e.g. `/hand`."""
        self._tree.delete(prefix, commands.delete(prefix))

    def update(self) -> None:
        """Draw what has arrived since the last call."""
        payload, self._state = self._state, None
        if payload is not None:
            self._follow_arm(payload)
        self._follow_hands()
        self._tree.flush()

    def _receive_state(self, key: str, payload: bytes) -> None:
        self._state = payload

    def _follow_arm(self, payload: bytes) -> None:
        try:
            state = decode_state(payload)
        except UnusableInput:
            return  # the next one comes in 10 ms; the executor reports it
        if len(state.position) != self._arm.joint_count:
            return  # as above
        self._pose_arm(state.position, gripper_closed=state.gripper_closed)
        if any(drawn.has_object for drawn in self._hands.values()):
            return  # the object is in a hand
        # an orientation of zeros says that the arm's scene has no object
        if any(state.object_orientation) and self._tree.paths("/object"):
            self._place("/object", commands.pose_of(state.object_position, state.object_orientation))

    def _put_part(self, part: LinkSolid) -> None:
        path = f"/robot/link{part.link}/{part.name.replace(' ', '-').replace('/', '-')}"
        pose = commands.pose_of(part.position, part.orientation)
        look = partial(commands.solid, pose=pose, color=part.color, outline=part.outline, vertices=part.vertices)
        self._tree.set_object(path, look(path, part.kind, part.size))
        if any(part.opening_offset):
            self._fingers.append((path, commands.pose_of(part.opening_offset)))

    def _pose_arm(self, q: Array, *, gripper_closed: bool) -> None:
        for i, frame in enumerate(link_frames(q, self._arm)):
            self._place(f"/robot/link{i}", frame)
        for path, opened in self._fingers:
            self._place(path, np.eye(4) if gripper_closed else opened)

    def _place(self, path: str, pose: Array) -> None:
        # A hundredth of a millimetre is less than a pixel: an arm at rest sends nothing.
        self._tree.set_transform(path, commands.transform(path, np.round(pose, 5) + 0.0))

    def _follow_hands(self) -> None:
        now = self._clock()
        for status in self._statuses():
            hand = status.hand
            if hand is None:
                continue
            drawn = self._hands.get(status.tracker)
            if drawn is None:
                drawn = self._hands[status.tracker] = _HandDrawing(deque(maxlen=self._settings.trail_points), now)
            if hand.received != drawn.received:
                drawn.last_sample, drawn.received = now, hand.received
                self._draw_hand(status.tracker, hand, drawn, now)
                self._draw_object(status, hand, drawn)
        limit = now - self._settings.hand_silence
        for tracker in [tracker for tracker, drawn in self._hands.items() if drawn.last_sample < limit]:
            self._put_back(self._hands.pop(tracker))
            self.clear(f"/hand/{tracker}")

    def _draw_hand(self, tracker: str, hand: HandState, drawn: _HandDrawing, now: float) -> None:
        marker, trail = f"/hand/{tracker}/marker", f"/hand/{tracker}/trail"
        if drawn.take != hand.take:
            drawn.take = hand.take
            drawn.trail.clear()
            self.clear(trail)
        drawn.trail.append(hand.position)
        if drawn.is_closed != hand.is_closed:
            drawn.is_closed = hand.is_closed
            color = CLOSED_HAND_COLOR if hand.is_closed else OPEN_HAND_COLOR
            self._tree.set_object(marker, commands.solid(marker, "sphere", (MARKER_RADIUS,), color=color))
        self._place(marker, commands.pose_of(hand.position))
        if len(drawn.trail) >= 2 and now - drawn.trail_drawn >= 1.0 / self._settings.trail_rate:
            drawn.trail_drawn = now
            self._tree.set_object(trail, commands.line(trail, np.array(drawn.trail), color=OPEN_HAND_COLOR))

    def _draw_object(self, status: RecordingStatus, hand: HandState, drawn: _HandDrawing) -> None:
        """Draw the object in the hand that carries it; once released, it stays there until the next reach begins."""
        if status.carried is None or status.carried != self._object or status.phase is None:
            return
        if status.phase.has_object:
            drawn.has_object = True
            if hand.carried_pose is not None:
                self._place("/object", commands.pose_of(*hand.carried_pose))
        elif status.phase is Phase.REACH:
            self._put_back(drawn)

    def _put_back(self, drawn: _HandDrawing) -> None:
        if drawn.has_object and self._object is not None:
            self._place_at_start(self._object)
        drawn.has_object = False

    def _place_at_start(self, carried: Shape) -> None:
        self._place("/object", commands.pose_of(carried.position, carried.orientation))
