"""A SpaceMouse as a source: its cap steers the hand, which stands where the cap is at rest."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

from teachpath_client.devices.polled_source import PolledSource
from teachpath_client.devices.source import configure
from teachpath_client.devices.spacemouse_hid import Deflection, SpaceMouse
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading, Quaternion, Vector
from teachpath_client.rotations import product, rotation, unit

GRASP_BUTTON = 1
SETTLING_TIME = 0.08  # [s] of the filter that makes a hand of the cap: a hand speeds up and slows down
LONGEST_STEP = 0.1  # [s] of motion after a pause of this program: the hand does not leap


@dataclass(frozen=True)
class SpaceMouseSettings:
    """How the cap steers."""

    # [m/s] at its stop
    speed: float = 0.25
    # [rad/s] at its stop
    turn: float = 1.0
    # [m] where the hand begins: x, y, z in the tracker's frame
    start: tuple[float, ...] = (0.0, 0.0, 0.0)
    # [Hz] of readings
    rate: float = 50.0
    # which device, as the system names it; empty: the first one
    path: str = ""

    def __post_init__(self) -> None:
        if len(self.start) != 3 or not all(map(math.isfinite, self.start)):
            raise ClientError(f"start={','.join(map(str, self.start))}: say three numbers [m], e.g. start=0.4,-0.2,0.5")
        for name, value, most in (("speed", self.speed, 2.0), ("turn", self.turn, 6.0), ("rate", self.rate, 200.0)):
            if not 0.0 < value <= most:
                raise ClientError(f"{name}={value:g} is not over 0 and at most {most:g}")


class SteeredHand:
    """A hand with the speed that the cap asks for, reached smoothly; a press of the first button grasps or lets go.

    Args:
        settings: how the cap steers.
    """

    def __init__(self, settings: SpaceMouseSettings) -> None:
        self._settings = settings
        x, y, z = settings.start
        self.position: Vector = (x, y, z)
        self.orientation: Quaternion = (1.0, 0.0, 0.0, 0.0)
        self.grasps: bool = False
        self._push: Vector = (0.0, 0.0, 0.0)
        self._twist: Vector = (0.0, 0.0, 0.0)
        self._pressed = False

    def advance(self, deflection: Deflection, seconds: float) -> None:
        """Move as the cap asks for `seconds` [s]."""
        share = -math.expm1(-seconds / SETTLING_TIME)
        self._push = _closer(self._push, deflection.push, share)
        self._twist = _closer(self._twist, deflection.twist, share)
        x, y, z = (p + self._settings.speed * seconds * v for p, v in zip(self.position, self._push, strict=True))
        i, j, k = (self._settings.turn * seconds * part for part in self._twist)
        self.position = (x, y, z)
        self.orientation = unit(product(rotation((i, j, k)), self.orientation))
        pressed = bool(deflection.buttons & 1)
        self.grasps ^= pressed and not self._pressed
        self._pressed = pressed

    def rest(self) -> None:
        """Stand at once."""
        self._push = self._twist = (0.0, 0.0, 0.0)


def _closer(now: Vector, wanted: Vector, share: float) -> Vector:
    x, y, z = (a + share * (b - a) for a, b in zip(now, wanted, strict=True))
    return x, y, z


class SpaceMouseSource(PolledSource):
    """Readings of a steered hand. While the device is unplugged the hand rests, and no reading is given.

    Args:
        settings: how the cap steers.
        mouse: the device.
        clock: [s] that never runs back.
        sleep: waits some seconds.
    """

    def __init__(
        self,
        settings: SpaceMouseSettings,
        mouse: SpaceMouse,
        *,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], object] = time.sleep,
    ) -> None:
        super().__init__(settings.rate, clock=clock, sleep=sleep)
        self._mouse, self._hand = mouse, SteeredHand(settings)
        self._asked = clock()

    def _connect(self) -> None:
        self._mouse.connect()
        self._asked = self._clock()

    def _disconnect(self) -> None:
        self._mouse.close()
        self._hand.rest()

    def _ask(self) -> HandReading:
        deflection, now = self._mouse.deflection(), self._clock()
        self._hand.advance(deflection, min(now - self._asked, LONGEST_STEP))
        self._asked = now
        buttons = GRASP_BUTTON if self._hand.grasps else 0
        return HandReading(0.0, self._hand.position, self._hand.orientation, buttons=buttons)


def spacemouse(**options: str) -> SpaceMouseSource:
    """A 3Dconnexion SpaceMouse; speed=0.25 [m/s], turn=1 [rad/s], start=X,Y,Z; its first button grasps and lets go."""
    settings = configure(SpaceMouseSettings, options)
    try:
        import hid
    except ModuleNotFoundError:
        raise ClientError("a SpaceMouse needs the package hidapi: pip install 'teachpath[spacemouse]'") from None

    def open_device(path: bytes) -> hid.device:
        device = hid.device()
        device.open_path(path)
        device.set_nonblocking(1)
        return device

    return SpaceMouseSource(settings, SpaceMouse(settings.path, open_device, hid.enumerate))
