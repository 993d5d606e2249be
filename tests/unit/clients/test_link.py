"""The link over a real Zenoh session, in processes of their own because a session may keep one from ending."""

import json
import subprocess
import sys
from typing import Any

import pytest
import zenoh

from teachpath_client.errors import ClientError
from teachpath_client.link import Link
from teachpath_proto.logins import Login, Role, logins_path, write_logins
from tests.ports import free_ports
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

CLIENT = """
import sys
from teachpath_client.link import Link
with Link(sys.argv[1]) as link:
    publisher = link.publisher("lab/trackers/a/samples")
    for i in range(200):
        publisher.put(str(i).encode())
"""


class Station:
    """A Zenoh peer that listens, as the service does."""

    def __init__(self) -> None:
        self.endpoint = f"tcp/127.0.0.1:{free_ports(1)[0]}"
        config = zenoh.Config()
        for path, value in {
            "mode": "peer",
            "listen/endpoints": [self.endpoint],
            "scouting/multicast/enabled": False,
            "scouting/gossip/enabled": False,
        }.items():
            config.insert_json5(path, json.dumps(value))
        self.session = zenoh.open(config)
        self.received: list[bytes] = []

    def __enter__(self) -> "Station":
        return self

    def __exit__(self, *_: object) -> None:
        self.session.close()

    def keep(self, sample: Any) -> None:
        self.received.append(bytes(sample.payload.to_bytes()))


@pytest.mark.parametrize("kind", ["plain", "advanced"])
def test_all_that_was_put_arrives_and_the_process_ends(kind: str) -> None:
    with Station() as station:
        if kind == "plain":
            subscriber = station.session.declare_subscriber("lab/**", station.keep)
        else:
            recovery = zenoh.ext.RecoveryConfig(heartbeat=True)
            subscriber = zenoh.ext.declare_advanced_subscriber(
                station.session, "lab/**", station.keep, recovery=recovery
            )
        command = [sys.executable, "-W", "error", "-c", CLIENT, station.endpoint]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=HANG)
        assert (ended.returncode, ended.stderr) == (0, "")
        wait_until(lambda: len(station.received) >= 200, "all arrived")
        assert station.received == [str(i).encode() for i in range(200)]
        subscriber.undeclare()


def test_a_subscriber_that_comes_late_can_ask_for_what_was_published() -> None:
    with Station() as station, Link(station.endpoint) as link:
        publisher = link.publisher("lab/trackers/a/samples")
        for i in range(50):
            publisher.put(str(i).encode())
        history = zenoh.ext.HistoryConfig(max_samples=1000)
        subscriber = zenoh.ext.declare_advanced_subscriber(station.session, "lab/**", station.keep, history=history)
        wait_until(lambda: len(station.received) >= 50, "the history arrived")
        assert station.received == [str(i).encode() for i in range(50)]
        subscriber.undeclare()


def test_a_station_that_is_not_there_is_said() -> None:
    with pytest.raises(ClientError, match="is `teachpath serve` running there"):
        Link(f"tcp/127.0.0.1:{free_ports(1)[0]}", timeout=0.2)


def test_the_login_of_a_station_that_is_gone_keeps_nobody_from_one_that_asks_for_none() -> None:
    with Station() as station:
        write_logins(logins_path(station.endpoint), [Login("tracker", "of before", Role.TRACKER)])
        with Link(station.endpoint, timeout=6.0):
            pass
        with pytest.raises(ClientError, match="does it still know the login 'tracker'"):
            Link(station.endpoint, login=Login("tracker", "of before", Role.TRACKER), timeout=0.2)
