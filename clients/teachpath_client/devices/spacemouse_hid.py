"""A 3Dconnexion SpaceMouse as a device of class HID: its reports, and the line that they come over.

The reports are those that spacenavd and the HID descriptors of the devices describe: 1 holds the translation, in newer
devices followed by the rotation, 2 the rotation of older ones, 3 the buttons, a bit each; numbers are little-endian.
The cap's axes are right, towards the user and down; readings have right, away from the user and up.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final, Protocol

from teachpath_client.errors import ClientError
from teachpath_client.reading import Vector

VENDOR: Final = 0x256F  # 3Dconnexion
FORMER_VENDOR: Final = 0x046D  # Logitech, which sold them until 2013 beside much else
FORMER_PRODUCTS: Final = range(0xC603, 0xC62C)  # of them, those that are 3D mice
TRANSLATION, ROTATION, BUTTONS = 1, 2, 3  # reports
AXES: Final = struct.Struct("<3h")
FULL_SCALE: Final = 350.0  # of an axis, at the cap's stop
REPORT_SIZE: Final = 64  # bytes at most
MAX_REPORTS: Final = 1000  # read in one go; a device sends some 125 a second


@dataclass(frozen=True, slots=True)
class Deflection:
    """How far the cap is moved from its rest, and which buttons are pressed.

    Attributes:
        push: along x (right), y (away from the user) and z (up), each -1 to 1.
        twist: about these axes, each -1 to 1.
        buttons: a bit for each; bit 0 is the first or left one.
    """

    push: Vector = (0.0, 0.0, 0.0)
    twist: Vector = (0.0, 0.0, 0.0)
    buttons: int = 0


class HidDevice(Protocol):
    """An opened device, as the package `hidapi` has it."""

    def read(self, max_length: int, timeout_ms: int = 0) -> Sequence[int]:
        """Return the next report, empty when none waits; raises OSError or ValueError when the device has gone."""

    def close(self) -> None:
        """Let go of it."""


def apply_report(deflection: Deflection, report: Sequence[int]) -> Deflection:
    """Return what is known after a report; one that is too short or unknown changes nothing."""
    content = bytes(report)
    kind, body = content[:1], content[1:]
    if kind == bytes([TRANSLATION]) and len(body) >= AXES.size:
        deflection = replace(deflection, push=_axes(body))
        newer = len(body) >= 2 * AXES.size
        return replace(deflection, twist=_axes(body[AXES.size :])) if newer else deflection
    if kind == bytes([ROTATION]) and len(body) >= AXES.size:
        return replace(deflection, twist=_axes(body))
    if kind == bytes([BUTTONS]) and body:
        return replace(deflection, buttons=int.from_bytes(body[:4], "little"))
    return deflection


def _axes(body: bytes) -> Vector:
    right, near, down = (max(-1.0, min(1.0, raw / FULL_SCALE)) for raw in AXES.unpack_from(body))
    return right, -near, -down


class SpaceMouse:
    """The first SpaceMouse, or the one at a path; a cap whose device has gone is at rest.

    Args:
        path: of the device, as the system names it; empty: the first one.
        open_device: opens a path; raises OSError.
        list_devices: the devices of class HID, each with `vendor_id`, `product_id` and `path`.
    """

    def __init__(
        self,
        path: str,
        open_device: Callable[[bytes], HidDevice],
        list_devices: Callable[[], Sequence[dict[str, Any]]],
    ) -> None:
        self._path, self._open, self._list = path, open_device, list_devices
        self._device: HidDevice | None = None
        self._deflection = Deflection()

    def connect(self) -> None:
        """Open the device; raises ClientError when there is none, or it may not be read."""
        path = self._path.encode() or self._first()
        try:
            self._device = self._open(path)
        except OSError as error:
            raise ClientError(
                f"cannot open the SpaceMouse {path.decode(errors='replace')}: {error}; may this user read it? "
                "Linux wants a rule for udev, see the documents"
            ) from None

    def close(self) -> None:
        """Let go of the device; a second call does nothing."""
        device, self._device, self._deflection = self._device, None, Deflection()
        if device is not None:
            device.close()

    def deflection(self) -> Deflection:
        """Return how the cap is moved now; raises ClientError when the device has gone."""
        if self._device is None:
            return self._deflection
        try:
            for _ in range(MAX_REPORTS):
                if not (report := self._device.read(REPORT_SIZE)):
                    break
                self._deflection = apply_report(self._deflection, report)
        except (OSError, ValueError) as error:
            raise ClientError(f"the SpaceMouse has gone: {error}") from None
        return self._deflection

    def _first(self) -> bytes:
        for each in self._list():
            former = each["vendor_id"] == FORMER_VENDOR and each["product_id"] in FORMER_PRODUCTS
            if each["vendor_id"] == VENDOR or former:
                return bytes(each["path"])
        raise ClientError("no SpaceMouse is connected; a wireless one needs its receiver")
