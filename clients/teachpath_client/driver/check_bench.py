"""The bus on which a driver is checked: the check listens, as a station does, and the driver connects to it."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Final

import zenoh

from teachpath_client.driver.check import DriverCheck
from teachpath_client.errors import ClientError
from teachpath_client.verdict import print_verdicts
from teachpath_proto.keys import Keys
from teachpath_proto.motion_pb2 import JointState
from teachpath_proto.sessions import listening, open_session

WAIT_INTERVAL: Final = 0.2  # [s] between two looks for the driver
WARNING = "The check moves every joint by 0.2 rad and back, seven times. Is the arm's space clear? [y/N] "


class BusBench:
    """Listens at an endpoint for one driver; use it as a context manager.

    Args:
        endpoint: where it listens.
        robot: name of the arm in its keys.
        prefix: of the keys.

    Raises:
        ClientError: it cannot listen there.
    """

    def __init__(self, endpoint: str, robot: str, prefix: str) -> None:
        keys = Keys(prefix)
        try:
            self._session = open_session(listening([endpoint]))
        except zenoh.ZError as error:
            raise ClientError(f"cannot listen at {endpoint}: is a station running there? ({error})") from error
        self.states: list[JointState] = []
        self._publisher = self._session.declare_publisher(
            keys.setpoint(robot), congestion_control=zenoh.CongestionControl.BLOCK
        )
        self._subscriber = self._session.declare_subscriber(keys.state(robot), self._receive)

    def __enter__(self) -> BusBench:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._session.close()  # type: ignore[no-untyped-call]

    def now_ns(self) -> int:
        """Return the time since the Unix epoch [ns]."""
        return time.time_ns()

    def wait_until(self, time_ns: int) -> None:
        """Wait until that time [ns]."""
        time.sleep(max(time_ns - time.time_ns(), 0) / 1e9)

    def publish(self, payload: bytes) -> None:
        """Publish a setpoint."""
        self._publisher.put(payload)

    def _receive(self, sample: zenoh.Sample) -> None:
        try:
            self.states.append(JointState.FromString(sample.payload.to_bytes()))
        except Exception as error:  # whatever the parser raises: the driver should be told
            print(f"a joint state cannot be read: {error}", file=sys.stderr)


def check_driver(endpoint: str, robot: str, prefix: str, *, tolerance: float, confirmed: bool) -> bool:
    """Check the driver that connects to `endpoint`, and print a verdict for every rule; returns whether it keeps all.

    Args:
        endpoint: where the check listens.
        robot: name of the arm in its keys.
        prefix: of the keys.
        tolerance: by which a joint may be off its setpoint while it follows [rad].
        confirmed: False asks before the arm moves.
    """
    with BusBench(endpoint, robot, prefix) as bench:
        print(f"waiting for a driver of {robot}: start it with --endpoint {endpoint} (Ctrl-C ends)", file=sys.stderr)
        while not bench.states:
            time.sleep(WAIT_INTERVAL)
        if not confirmed and input(WARNING).strip().lower() not in ("y", "yes"):
            raise ClientError("nothing was moved and nothing checked; --yes answers the question")
        return print_verdicts(DriverCheck(bench, tolerance).run())
