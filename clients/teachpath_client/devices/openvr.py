"""Trackers and controllers of SteamVR as sources, by OpenVR: Vive trackers, Index and Vive controllers and others."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Protocol

from teachpath_client.devices.polled_source import PolledSource
from teachpath_client.devices.source import configure
from teachpath_client.errors import ClientError
from teachpath_client.reading import HandReading
from teachpath_client.rotations import of_matrix

GRASP_BUTTON = 1

# Numbers of openvr.h, which never change there.
MAX_DEVICES: Final = 64
CONTROLLER_CLASS, TRACKER_CLASS = 2, 3  # classes of devices
ROLES: Final = {"left": 1, "right": 2}  # of controllers
STANDING_UNIVERSE: Final = 1  # the frame: that of the room, with y up
TRACKING_RUNS: Final = 200  # result of tracking that can be relied on
BACKGROUND_APPLICATION: Final = 3  # kind of application that starts nothing by itself
TRIGGER: Final = 33  # button; a tracker has it as a pin
SERIAL_NUMBER: Final = 1002  # property
QUIT_EVENT: Final = 700  # event


@dataclass(frozen=True)
class OpenVrSettings:
    """What is followed."""

    # serial number, or left or right of the controllers; empty: the first tracker, else the first controller
    device: str = ""
    # [Hz] of readings
    rate: float = 50.0

    def __post_init__(self) -> None:
        if not 0.0 < self.rate <= 250.0:
            raise ClientError(f"rate={self.rate:g} is not over 0 and at most 250")


class TrackingSystem(Protocol):
    """The part of `openvr.IVRSystem` that is used."""

    def getTrackedDeviceClass(self, index: int) -> int:  # noqa: N802 - their name
        """Return which class of device has a number."""

    def getControllerRoleForTrackedDeviceIndex(self, index: int) -> int:  # noqa: N802 - their name
        """Return in which hand a controller is."""

    def getStringTrackedDeviceProperty(self, index: int, prop: int) -> str:  # noqa: N802 - their name
        """Return a text that describes a device."""

    def getDeviceToAbsoluteTrackingPose(self, origin: int, seconds: float, poses: Any) -> Any:  # noqa: N802 - their name
        """Return the poses of all devices, in some seconds."""

    def getControllerState(self, index: int) -> tuple[Any, Any]:  # noqa: N802 - their name
        """Return whether a device has buttons, and how they are."""

    def pollNextEvent(self, event: Any) -> bool:  # noqa: N802 - their name
        """Fill in the next event; tell whether there was one."""


class OpenVrSource(PolledSource):
    """Readings of one device; the trigger says that the hand grasps.

    A device that is out of sight gives poses that are marked as not tracked as long as SteamVR guesses them, and none
    after that.

    Args:
        settings: what is followed.
        init: connects with SteamVR; raises `error`.
        shutdown: disconnects.
        new_event: makes an empty event.
        error: what the library raises.
        clock: [s] that never runs back.
        sleep: waits some seconds.
    """

    def __init__(
        self,
        settings: OpenVrSettings,
        init: Callable[[int], TrackingSystem],
        shutdown: Callable[[], object],
        new_event: Callable[[], Any],
        error: type[Exception],
        *,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], object] = time.sleep,
    ) -> None:
        super().__init__(settings.rate, clock=clock, sleep=sleep)
        self._wanted, self._init, self._shutdown = settings.device, init, shutdown
        self._new_event, self._error = new_event, error
        self._system: TrackingSystem | None = None
        self._index = -1

    def _connect(self) -> None:
        try:
            system = self._init(BACKGROUND_APPLICATION)
        except self._error as error:
            raise ClientError(f"SteamVR does not answer ({error or type(error).__name__}); start it first") from None
        self._system = system
        try:
            self._index = self._found(system)
        except ClientError:
            self._disconnect()
            raise

    def _disconnect(self) -> None:
        if self._system is not None:
            self._system = None
            self._shutdown()

    def _ask(self) -> HandReading | None:
        system = self._system
        if system is None:
            return None
        event = self._new_event()
        while system.pollNextEvent(event):
            if event.eventType == QUIT_EVENT:
                raise ClientError("SteamVR has ended")
        pose = system.getDeviceToAbsoluteTrackingPose(STANDING_UNIVERSE, 0.0, None)[self._index]
        if not pose.bDeviceIsConnected:
            raise ClientError(f"the device {self._wanted or self._index} of SteamVR is switched off")
        if not pose.bPoseIsValid:
            return None
        rows = [tuple(float(value) for value in row) for row in pose.mDeviceToAbsoluteTracking.m]
        (a, b, c, x), (d, e, f, y), (g, h, i, z) = rows
        _, buttons = system.getControllerState(self._index)
        return HandReading(
            0.0,
            (x, y, z),
            of_matrix(((a, b, c), (d, e, f), (g, h, i))),
            tracked=pose.eTrackingResult == TRACKING_RUNS,
            buttons=GRASP_BUTTON if int(buttons.ulButtonPressed) >> TRIGGER & 1 else 0,
        )

    def _found(self, system: TrackingSystem) -> int:
        """Return the number of the device that is wanted; raises ClientError that names those there are."""
        kinds = {index: system.getTrackedDeviceClass(index) for index in range(MAX_DEVICES)}
        there = [index for kind in (TRACKER_CLASS, CONTROLLER_CLASS) for index in kinds if kinds[index] == kind]
        names = {index: system.getStringTrackedDeviceProperty(index, SERIAL_NUMBER) for index in there}
        if self._wanted in ROLES:
            role = ROLES[self._wanted]
            fitting = [index for index in there if system.getControllerRoleForTrackedDeviceIndex(index) == role]
        else:
            fitting = [index for index in there if self._wanted in ("", names[index])]
        if not fitting:
            known = ", ".join(names.values())
            raise ClientError(f"SteamVR has no device {self._wanted or 'that is tracked'}; it has: {known or 'none'}")
        return fitting[0]


def openvr(**options: str) -> OpenVrSource:
    """A tracker or controller of SteamVR; device=SERIAL, left or right (the first tracker); the trigger grasps."""
    settings = configure(OpenVrSettings, options)
    try:
        import openvr as library
    except ModuleNotFoundError:
        raise ClientError("SteamVR needs the package openvr: pip install 'teachpath[openvr]'") from None
    except OSError as error:
        raise ClientError(f"openvr has no library for this computer: {error}") from None
    return OpenVrSource(settings, library.init, library.shutdown, library.VREvent_t, library.error_code.OpenVRError)
