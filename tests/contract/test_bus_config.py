"""The file of Zenoh's own configuration: what it says holds, and what the station sets itself is refused there."""

import itertools
import queue
import re
import time
from pathlib import Path

import pytest

from teachpath.errors import UnusableSettings
from teachpath.io.bus import BusSettings, listen_on_bus, open_bus
from teachpath_proto.keys import Keys
from tests.ports import free_endpoint

DOCUMENT = Path(__file__).parents[2] / "docs" / "several-machines.md"
TLS = "tls/127.0.0.1:7447"
# The fields of the settings, what the file says, and the sentence.
REFUSED_CONFIGS = [
    ({}, "{mode: 'client'}", "sets mode, which the station does itself: it is the setting bus.mode"),
    ({}, "{namespace: 'cell'}", "sets namespace, .* the setting bus.prefix"),
    ({}, "{listen: {endpoints: []}}", "sets listen, .* the setting bus.endpoint"),
    ({}, "{scouting: {multicast: {enabled: true}}}", "sets scouting, .* looks for nobody"),
    ({}, "{access_control: {enabled: false}}", "sets access_control, .* teachpath login create"),
    ({}, "{transport: {auth: {usrpwd: {user: 'me'}}}}", "sets transport/auth, .* teachpath login create"),
    ({}, "{connect: {endpoints: []}}", r"sets connect, .* joins it with one of its own \(deploy/zenohd-site.json5\)"),
    ({"mode": "client", "access_control": False}, "{connect: {}}", "sets connect, .* joins the router at the setting"),
    ({"endpoint": TLS}, "{transport: {link: {tls: {}}}}", "sets transport/link/tls, .* the setting bus.certificates"),
    ({}, "{transport: 1", "is not JSON5"),
    ({}, "{id: 'a', id: 'b'}", "is not JSON5: Duplicate key"),
    ({}, "[]", "is not an object of Zenoh's settings"),
    ({}, "{transprot: {}}", "Zenoh refuses transprot in .*: unknown key; its documents"),
    (
        {},
        "{transport: {link: {tx: {batch_size: 'big'}}}}",
        "Zenoh refuses transport/link/tx/batch_size in .*: error parsing number; its documents",
    ),
]


@pytest.mark.parametrize(("settings", "text", "sentence"), REFUSED_CONFIGS)
def test_what_contradicts_the_station_is_refused_with_the_way_out(
    tmp_path: Path, settings: dict[str, object], text: str, sentence: str
) -> None:
    file = tmp_path / "zenoh.json5"
    file.write_text(text)
    given = {"endpoint": free_endpoint(), "config": str(file), **settings}
    with pytest.raises(UnusableSettings, match=sentence) as refused:
        listen_on_bus(BusSettings(**given))  # type: ignore[arg-type]
    assert str(file) in str(refused.value)
    assert "/cargo/" not in str(refused.value)


@pytest.mark.parametrize("name", ["none.json5", "."])
def test_a_file_that_cannot_be_read_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(UnusableSettings, match=r"cannot read .* \(bus.config\)"):
        listen_on_bus(BusSettings(free_endpoint(), config=str(tmp_path / name)))


def test_two_stations_that_a_file_links_hear_of_each_other_what_they_ask_for_and_no_trackers(tmp_path: Path) -> None:
    one = BusSettings(free_endpoint(), mode="router", prefix="cell/1", access_control=False)
    file = tmp_path / "zenoh.json5"
    (documented,) = re.findall(r"```json5\n(.+?)```", DOCUMENT.read_text(), re.DOTALL)
    file.write_text(documented.replace("tcp/cell-2.example:7447", one.endpoint))
    two = BusSettings(free_endpoint(), mode="router", config=str(file), prefix="cell/2", access_control=False)
    here, there = listen_on_bus(one), listen_on_bus(two)
    tracker = open_bus(one)
    heard: queue.Queue[str] = queue.Queue()
    there.subscribe(Keys(two.prefix).all_samples, lambda key, _: heard.put(key))
    there.subscribe(Keys(one.prefix).executor_status, lambda key, _: heard.put(key))
    sent = itertools.cycle((Keys(one.prefix).samples("glove"), Keys(one.prefix).executor_status))
    while heard.qsize() < 10:  # until the routers know who asks for what; then all of both keys passes this way
        tracker.publish(next(sent), b"")
        time.sleep(0.001)
    assert {heard.get() for _ in range(10)} == {Keys(one.prefix).executor_status}
    for bus in (tracker, there, here):
        bus.close()
