"""A SpaceMouse: its reports byte by byte, and a source beside a device that misbehaves, in time of its own."""

import itertools
import math
from collections import deque
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pytest

from teachpath_client.devices.source import configure
from teachpath_client.devices.spacemouse import SpaceMouseSettings, SpaceMouseSource
from teachpath_client.devices.spacemouse_hid import Deflection, SpaceMouse, apply_report
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from tests.unit.clients.devices.scripted_time import ScriptedTime

NEWER = {"vendor_id": 0x256F, "product_id": 0xC635, "path": b"1-1:1.0"}
FORMER = {"vendor_id": 0x046D, "product_id": 0xC626, "path": b"1-2:1.0"}
KEYBOARD = {"vendor_id": 0x046D, "product_id": 0xC31C, "path": b"1-3:1.0"}
LEFT_BUTTON = bytes([3, 1, 0])


def pushed(right: int = 0, near: int = 0, down: int = 0, *, twist: tuple[int, int, int] = (0, 0, 0)) -> bytes:
    return b"\x01" + b"".join(each.to_bytes(2, "little", signed=True) for each in (right, near, down, *twist))


class Device:
    """A device of class HID as an emulator: it says what it is told to, tears reports, and is pulled out.

    Attributes:
        reports: that wait to be read.
        plugged: whether it is there.
        closed: how often it was let go of.
    """

    def __init__(self) -> None:
        self.reports: deque[bytes] = deque()
        self.plugged = True
        self.closed = 0

    def plug(self) -> None:
        self.plugged = True

    def open(self, path: bytes) -> "Device":
        if not self.plugged:
            raise OSError(f"open failed of {path.decode()}")
        return self

    def read(self, max_length: int, timeout_ms: int = 0) -> Sequence[int]:
        if not self.plugged:
            raise OSError("read error")
        return list(self.reports.popleft()[:max_length]) if self.reports else []

    def close(self) -> None:
        self.closed += 1


def source(
    device: Device, clock: ScriptedTime, found: Sequence[dict[str, Any]] = (KEYBOARD, NEWER), **options: str
) -> Any:
    mouse = SpaceMouse(options.get("path", ""), device.open, lambda: list(found))
    settings = configure(SpaceMouseSettings, options)
    return SpaceMouseSource(settings, mouse, clock=clock.clock, sleep=clock.sleep)


def readings(stream: Iterator[HandReading], seconds: float) -> list[HandReading]:
    """Return the readings of the next seconds, at 50 Hz."""
    return list(itertools.islice(stream, round(50.0 * seconds)))


def test_reports_are_read_byte_by_byte() -> None:
    newer = apply_report(Deflection(), bytes.fromhex("01 5e01 a2fe 0000 af00 0000 51ff"))
    assert newer == Deflection((1.0, 1.0, 0.0), (0.5, 0.0, 0.5))
    older = apply_report(
        apply_report(Deflection(), bytes.fromhex("01 0000 0000 51ff")), bytes.fromhex("02 0000 af00 0000")
    )
    assert older == Deflection((0.0, 0.0, 0.5), (0.0, -0.5, 0.0))
    assert apply_report(older, bytes.fromhex("03 02 00")) == Deflection(older.push, older.twist, buttons=2)


def test_any_bytes_leave_a_deflection_within_its_bounds() -> None:
    deflection, chance = Deflection(), np.random.default_rng(1)
    for _ in range(2000):
        deflection = apply_report(deflection, [int(chance.integers(1, 5)), *chance.bytes(int(chance.integers(0, 20)))])
        assert max(map(abs, (*deflection.push, *deflection.twist))) <= 1.0
    assert apply_report(Deflection(), b"") == Deflection()


def test_a_held_cap_moves_the_hand_at_its_speed_and_a_released_one_lets_it_rest() -> None:
    device, clock = Device(), ScriptedTime()
    device.reports.append(pushed(350, 0, -175, twist=(0, 0, -350)))
    with source(device, clock, speed="0.2", turn="0.5", start="0.4,-0.2,0.5") as mouse:
        stream = iter(mouse)
        moving = readings(stream, 2.0)
        device.reports.append(pushed())
        resting = readings(stream, 2.0)
    steps = np.diff([reading.position for reading in moving], axis=0) * 50.0
    assert moving[0].position == pytest.approx((0.4, -0.2, 0.5), abs=0.01)
    np.testing.assert_allclose(steps[-1], (0.2, 0.0, 0.1), atol=1e-6)
    slowed = np.linalg.norm(np.diff([reading.position for reading in resting], axis=0), axis=1)
    assert (np.diff(slowed) <= 1e-12).all(), "it slows down, and never stops at once as a frozen tracker does"
    assert slowed[-1] < 1e-9
    angle = 2.0 * math.atan2(resting[-1].orientation[3], resting[-1].orientation[0])  # type: ignore[index]
    assert angle == pytest.approx(0.5 * moving[-1].time, abs=0.05)
    times = [reading.time for reading in moving + resting]
    np.testing.assert_allclose(np.diff(times), 0.02, atol=2e-3)


def test_a_press_grasps_and_the_next_lets_go() -> None:
    device, clock = Device(), ScriptedTime()
    held = []
    with source(device, clock) as mouse:
        stream = iter(mouse)
        for report in (LEFT_BUTTON, bytes([3, 0, 0]), LEFT_BUTTON, LEFT_BUTTON, bytes([3, 2, 0])):
            device.reports.append(report)
            held.append(next(stream).buttons)
    assert held == [1, 1, 0, 0, 0]


def test_the_hand_rests_while_the_device_is_unplugged_and_goes_on_from_there(caplog: pytest.LogCaptureFixture) -> None:
    device, clock = Device(), ScriptedTime()
    device.reports.append(pushed(350))
    with source(device, clock) as mouse:
        stream = iter(mouse)
        before = readings(stream, 1.0)[-1]
        device.plugged = False
        clock.after(7.0, device.plug)
        after = readings(stream, 0.5)
    assert after[0].time - before.time >= 7.0
    places = np.array([reading.position for reading in after])
    assert np.ptp(places, axis=0).max() == 0.0, "a cap whose device had gone pushes no more"
    np.testing.assert_allclose(places[0], before.position, atol=0.25 / 50 + 1e-9)
    assert "the SpaceMouse has gone: read error; trying again until it is back" in caplog.text
    assert device.closed == 2


def test_a_stalled_program_makes_no_leap() -> None:
    device, clock = Device(), ScriptedTime()
    device.reports.append(pushed(350))
    with source(device, clock) as mouse:
        stream = iter(mouse)
        before = next(stream)
        clock.now += 5.0
        after = next(stream)
    assert 0.0 < after.position[0] - before.position[0] <= 0.25 * 0.1


@pytest.mark.parametrize(("found", "opened"), [((KEYBOARD, FORMER), True), ((KEYBOARD,), False), ((), False)])
def test_the_first_spacemouse_is_taken(found: Sequence[dict[str, Any]], opened: bool) -> None:
    mouse = source(Device(), ScriptedTime(), found)
    if opened:
        with mouse:
            assert mouse.capabilities.live
    else:
        with pytest.raises(ClientError, match="no SpaceMouse is connected"), mouse:
            pass


def test_a_device_that_may_not_be_read_is_said() -> None:
    device = Device()
    device.plugged = False
    with pytest.raises(ClientError, match=r"cannot open the SpaceMouse 1-1:1\.0: .* may this user read it"):
        source(device, ScriptedTime()).__enter__()


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"start": "1,2"}, "start=1.0,2.0: say three numbers"),
        ({"start": "1,2,nan"}, "start=1.0,2.0,nan: say three numbers"),
        ({"start": "here"}, "start=here is not usable"),
        ({"speed": "0"}, "speed=0 is not over 0 and at most 2"),
        ({"rate": "inf"}, "rate=inf is not over 0 and at most 200"),
        ({"turn": "nan"}, "turn=nan is not over 0 and at most 6"),
    ],
)
def test_options_that_are_not_usable_are_said(options: dict[str, str], sentence: str) -> None:
    with pytest.raises(ClientError, match=sentence):
        source(Device(), ScriptedTime(), **options)
