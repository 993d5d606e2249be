"""OpenVR: a source beside a SteamVR that misbehaves, in time of its own, and the numbers of the real library."""

import math
from collections import deque
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest

from teachpath_client.devices import openvr as source
from teachpath_client.devices.openvr import OpenVrSettings, OpenVrSource, TrackingSystem
from teachpath_client.devices.source import configure
from teachpath_client.errors import ClientError
from teachpath_client.rotations import of_matrix, product, rotation, turned
from tests.unit.clients.devices.scripted_time import ScriptedTime

try:
    import openvr as library
except (ImportError, OSError):  # it has none for this processor
    library = None

OUT_OF_RANGE = 201  # result of tracking


class NoSteamVr(Exception):
    """What the library raises."""


class SteamVr:
    """SteamVR with a headset, two controllers and a tracker, as an emulator that ends, loses and switches off devices.

    Args:
        kinds: classes of its devices, by their numbers.

    Attributes:
        time: its time.
        runs: whether it can be connected with.
        events: that it will tell of.
        off, lost, guessed: numbers of devices that are switched off, out of sight, or out of sight but guessed.
        pressed: buttons of the devices, by their numbers.
        connections: how often somebody connected, and how often they let go.
    """

    KINDS: ClassVar = {0: 1, 1: source.CONTROLLER_CLASS, 2: source.CONTROLLER_CLASS, 5: source.TRACKER_CLASS}

    def __init__(self, kinds: dict[int, int] | None = None) -> None:
        self.time, self.runs, self._kinds = ScriptedTime(), True, self.KINDS if kinds is None else kinds
        self.events: deque[int] = deque()
        self.off: set[int] = set()
        self.lost: set[int] = set()
        self.guessed: set[int] = set()
        self.pressed: dict[int, int] = {}
        self.connections = [0, 0]

    def source(self, **options: str) -> OpenVrSource:
        return OpenVrSource(
            configure(OpenVrSettings, options),
            self._init,
            self._shutdown,
            lambda: SimpleNamespace(eventType=0),
            NoSteamVr,
            clock=self.time.clock,
            sleep=self.time.sleep,
        )

    def start(self) -> None:
        self.runs = True

    def _init(self, kind: int) -> "SteamVr":
        if not self.runs:
            raise NoSteamVr("Init_NoServerForBackgroundApp")
        self.connections[0] += 1
        return self

    def _shutdown(self) -> None:
        self.connections[1] += 1

    def getTrackedDeviceClass(self, index: int) -> int:  # noqa: N802 - their name
        return self._kinds.get(index, 0)

    def getControllerRoleForTrackedDeviceIndex(self, index: int) -> int:  # noqa: N802 - their name
        return {1: 1, 2: 2}.get(index, 0)

    def getStringTrackedDeviceProperty(self, index: int, prop: int) -> str:  # noqa: N802 - their name
        assert prop == source.SERIAL_NUMBER
        return f"LHR-{index}"

    def getDeviceToAbsoluteTrackingPose(self, origin: int, seconds: float, poses: Any) -> Any:  # noqa: N802 - their name
        return [self._pose(index) for index in range(source.MAX_DEVICES)]

    def getControllerState(self, index: int) -> tuple[Any, Any]:  # noqa: N802 - their name
        return True, SimpleNamespace(ulButtonPressed=self.pressed.get(index, 0))

    def pollNextEvent(self, event: Any) -> bool:  # noqa: N802 - their name
        if self.events:
            event.eventType = self.events.popleft()
            return True
        return False

    def _pose(self, index: int) -> Any:
        matrix = [[0.0, -1.0, 0.0, self.time.now], [1.0, 0.0, 0.0, 0.1 * index], [0.0, 0.0, 1.0, -2.0]]
        return SimpleNamespace(
            bDeviceIsConnected=index not in self.off,
            bPoseIsValid=index not in self.lost,
            eTrackingResult=OUT_OF_RANGE if index in self.guessed else source.TRACKING_RUNS,
            mDeviceToAbsoluteTracking=SimpleNamespace(m=matrix),
        )


@pytest.mark.parametrize(("device", "index"), [("", 5), ("LHR-2", 2), ("left", 1), ("right", 2)])
def test_the_device_that_is_wanted_is_followed(device: str, index: int) -> None:
    steam = SteamVr()
    steam.pressed = {index: 1 << source.TRIGGER, 7: 1 << source.TRIGGER}
    with steam.source(device=device) as followed:
        stream = iter(followed)
        readings = [next(stream) for _ in range(10)]
    half = math.sqrt(0.5)
    for reading in readings:
        assert reading.position == pytest.approx((reading.time, 0.1 * index, -2.0), abs=1e-9)
        assert reading.orientation == pytest.approx((half, 0.0, 0.0, half))
        assert (reading.tracked, reading.buttons) == (True, 1)
    np.testing.assert_allclose(np.diff([reading.time for reading in readings]), 0.02, atol=2e-3)
    assert steam.connections == [1, 1]


def test_what_is_guessed_is_marked_and_what_is_lost_is_missing() -> None:
    steam = SteamVr()
    with steam.source() as followed:
        stream = iter(followed)
        steam.guessed = {5}
        guessed = next(stream)
        steam.guessed, steam.lost = set(), {5}
        steam.time.after(1.0, steam.lost.clear)
        found = next(stream)
    assert (guessed.tracked, found.tracked) == (False, True)
    assert found.time - guessed.time >= 1.0


def test_a_steamvr_that_ends_is_tried_until_it_is_back(caplog: pytest.LogCaptureFixture) -> None:
    steam = SteamVr()
    with steam.source() as followed:
        stream = iter(followed)
        before = next(stream)
        steam.runs = False
        steam.time.after(9.0, steam.start)
        steam.events.extend([100, source.QUIT_EVENT])
        after = next(stream)
    assert after.time - before.time >= 9.0
    assert "SteamVR has ended; trying again until it is back" in caplog.text
    assert steam.connections == [2, 2], "whoever connects lets go"


def test_a_device_that_is_switched_off_is_waited_for(caplog: pytest.LogCaptureFixture) -> None:
    steam = SteamVr()
    with steam.source(device="LHR-1") as followed:
        stream = iter(followed)
        before = next(stream)
        steam.off = {1}
        steam.time.after(5.0, steam.off.clear)
        after = next(stream)
    assert after.time - before.time >= 5.0
    assert "the device LHR-1 of SteamVR is switched off; trying again" in caplog.text


def test_a_source_that_is_closed_while_it_tries_again_ends() -> None:
    steam = SteamVr()
    with steam.source() as followed:
        stream = iter(followed)
        next(stream)
        steam.runs = False
        steam.time.after(3.0, followed.close)
        steam.events.append(source.QUIT_EVENT)
        assert list(stream) == []


@pytest.mark.parametrize(
    ("kinds", "options", "sentence"),
    [
        (SteamVr.KINDS, {"device": "LHR-9"}, "SteamVR has no device LHR-9; it has: LHR-5, LHR-1, LHR-2"),
        ({0: 1}, {}, "SteamVR has no device that is tracked; it has: none"),
        ({5: source.TRACKER_CLASS}, {"device": "left"}, "SteamVR has no device left; it has: LHR-5"),
    ],
)
def test_a_device_that_is_not_there_is_said(kinds: dict[int, int], options: dict[str, str], sentence: str) -> None:
    steam = SteamVr(kinds)
    with pytest.raises(ClientError, match=sentence), steam.source(**options):
        pass
    assert steam.connections == [1, 1]


def test_a_steamvr_that_does_not_run_is_said() -> None:
    steam = SteamVr()
    steam.runs = False
    with pytest.raises(ClientError, match=r"SteamVR does not answer .*; start it first"), steam.source():
        pass


def test_a_rotation_is_found_from_any_matrix() -> None:
    chance = np.random.default_rng(3)
    for scale in (1e-9, 1.0, math.pi):
        for _ in range(50):
            x, y, z = (float(each) for each in chance.normal(size=3) * scale)
            wanted = rotation((x, y, z))
            columns = [turned(wanted, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
            found = of_matrix(tuple(zip(*columns, strict=True)))  # type: ignore[arg-type]
            w, *_ = product(found, (wanted[0], -wanted[1], -wanted[2], -wanted[3]))
            assert abs(w) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.skipif(library is None, reason="the package openvr has no library for this processor")
def test_the_numbers_and_fields_are_those_of_the_library() -> None:
    assert library is not None
    numbers = {
        "k_unMaxTrackedDeviceCount": source.MAX_DEVICES,
        "TrackedDeviceClass_Controller": source.CONTROLLER_CLASS,
        "TrackedDeviceClass_GenericTracker": source.TRACKER_CLASS,
        "TrackedControllerRole_LeftHand": source.ROLES["left"],
        "TrackedControllerRole_RightHand": source.ROLES["right"],
        "TrackingUniverseStanding": source.STANDING_UNIVERSE,
        "TrackingResult_Running_OK": source.TRACKING_RUNS,
        "VRApplication_Background": source.BACKGROUND_APPLICATION,
        "k_EButton_SteamVR_Trigger": source.TRIGGER,
        "Prop_SerialNumber_String": source.SERIAL_NUMBER,
        "VREvent_Quit": source.QUIT_EVENT,
    }
    assert {name: int(getattr(library, name)) for name in numbers} == numbers
    theirs, ours = library.TrackedDevicePose_t(), SteamVr()._pose(0)
    for name in vars(ours):
        assert hasattr(theirs, name)
    assert [len(row) for row in theirs.mDeviceToAbsoluteTracking.m] == [4, 4, 4]
    assert library.VREvent_t().eventType == library.VRControllerState_t().ulButtonPressed == 0
    for name in vars(TrackingSystem):
        assert name.startswith("_") or hasattr(library.IVRSystem, name)
