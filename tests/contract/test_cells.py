"""A router between two stations, by its sample: they hear what it was given a login for, and no more."""

import os
import queue
import time
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import json5
import pytest
import zenoh

from teachpath.io import certificates
from teachpath.io.bus import Bus, listen_on_bus, open_bus
from teachpath.io.bus_access import BusAccess
from teachpath.io.bus_logins import prepare_access
from teachpath.io.bus_settings import BusSettings
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Login, Role
from tests.ports import free_endpoint
from tests.waiting import wait_until

SAMPLE = Path(__file__).parents[2] / "deploy" / "zenohd-site.json5"
CURRENT_TIME = datetime.now(UTC)
CELLS = {"cell-1": Role.VIEWER, "cell-2": Role.TRACKER}  # what the router's login may do there


def cell(folder: Path, name: str) -> BusSettings:
    """Make the certificates of a station, and one for the router."""
    bus = BusSettings(free_endpoint().replace("tcp/", "tls/"), prefix=f"site/{name}", certificates=str(folder / name))
    certificates.prepare_authority(folder / name, CURRENT_TIME)
    for role in set(Role) - {Role.ROUTER}:
        hosts = ["127.0.0.1"] if role is Role.SERVICE else []
        certificates.issue(folder / name, Login(role.value, "", role), CURRENT_TIME, hosts=hosts)
    certificates.issue(folder / name, Login("site", "", CELLS[name]), CURRENT_TIME)
    return bus


@pytest.fixture(scope="module")
def stations(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, tuple[BusSettings, BusAccess, Bus]]]:
    folder = tmp_path_factory.mktemp("cells")
    found = {}
    for name in CELLS:
        bus = cell(folder, name)
        access = prepare_access(bus)
        assert access is not None
        found[name] = (bus, access, listen_on_bus(bus, access))
    yield found
    for _, _, service in found.values():
        service.close()


@pytest.fixture(scope="module")
def site(stations: dict[str, tuple[BusSettings, BusAccess, Bus]]) -> Iterator[Bus]:
    """A program that has joined a router of the sample; only addresses and folders are others."""
    said = SAMPLE.read_text()
    here = BusSettings(free_endpoint(), access_control=False)
    for name, (bus, _, _) in stations.items():
        said = said.replace(f"tls/{name}.example:7447", bus.endpoint).replace(
            f"/etc/teachpath/{name}/", f"{bus.certificates}/"
        )
    document = json5.loads(said.replace(json5.loads(said)["listen"]["endpoints"][0], here.endpoint))
    assert ".example" not in str(document)
    router = zenoh.open(zenoh.Config.from_json5(json5.dumps(document)))
    program = open_bus(here)
    yield program
    program.close()
    router.close()  # type: ignore[no-untyped-call]


def listening_at(service: Bus, *keys: str) -> "queue.Queue[str]":
    heard: queue.Queue[str] = queue.Queue()
    for key in keys:
        service.subscribe(key, lambda key, _: heard.put(key))
    return heard


def heard_of(heard: "queue.Queue[str]", sender: Bus, *keys: str) -> set[str]:
    """Publish on all keys, the last one at last, until that is heard; return what was."""
    came: set[str] = set()

    def last_came() -> bool:
        for key in keys:
            sender.publish(key, b"")
        while not heard.empty():
            came.add(heard.get())
        return keys[-1] in came

    wait_until(last_came, f"{keys[-1]} is heard", pause=lambda _: time.sleep(0.01))
    return came


def test_who_joins_the_router_sees_both_stations_as_its_logins_may(
    stations: dict[str, tuple[BusSettings, BusAccess, Bus]], site: Bus
) -> None:
    bus, access, _ = stations["cell-1"]
    keys = Keys(bus.prefix)
    glove = open_bus(bus, access.login(Role.TRACKER))
    heard = listening_at(site, keys.all_samples)
    assert heard_of(heard, glove, keys.samples("glove")) == {keys.samples("glove")}
    glove.close()


def test_a_station_hears_no_tracker_of_another_or_of_the_site_unless_a_login_says_so(
    stations: dict[str, tuple[BusSettings, BusAccess, Bus]], site: Bus
) -> None:
    (first, access, one), (second, _, two) = stations["cell-1"], stations["cell-2"]
    here, there = Keys(first.prefix), Keys(second.prefix)
    foreign = (here.samples("glove"), there.samples("glove"))
    at_one = listening_at(one, here.all_samples, there.all_samples, here.executor_stop)
    assert heard_of(at_one, site, *foreign, here.executor_stop) == {here.executor_stop}
    at_two = listening_at(two, here.all_samples, there.all_samples)
    assert heard_of(at_two, site, *foreign) == {there.samples("glove")}
    glove = open_bus(first, access.login(Role.TRACKER))
    at_one, seen = listening_at(one, here.all_samples, there.all_samples), listening_at(site, here.all_samples)
    assert heard_of(at_one, glove, *reversed(foreign)) == {here.samples("glove")}
    heard_of(seen, glove, here.samples("glove"))  # the router has passed it on to all that it passes it on to
    assert heard_of(at_two, site, there.samples("glove")) == {there.samples("glove")}
    glove.close()


def test_the_sample_leaves_nobody_else_in() -> None:
    document = json5.loads(SAMPLE.read_text())
    assert document["mode"] == "router"
    assert all("127.0.0.1" in endpoint for endpoint in document["listen"]["endpoints"])
    assert not any(way["enabled"] for way in document["scouting"].values())
    for name, endpoint in zip(CELLS, document["connect"]["endpoints"], strict=True):
        assert endpoint.startswith(f"tls/{name}.")
        assert "enable_mtls=true;verify_name_on_connect=true" in endpoint
        assert all(os.path.dirname(path) == f"/etc/teachpath/{name}" for path in _files(endpoint))


def _files(endpoint: str) -> list[str]:
    values = dict(part.split("=") for part in endpoint.partition("#")[2].split(";"))
    return [value for name, value in values.items() if name.endswith("_file")]
