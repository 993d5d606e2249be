"""Every role on the bus, every key, every verb: what the table grants goes through, and nothing else."""

import queue
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
import zenoh

from teachpath.errors import Unreachable
from teachpath.io.bus import Bus, BusSettings, listen_on_bus, open_bus
from teachpath.io.bus_access import BusAccess, granted
from teachpath.io.bus_logins import new_password
from teachpath_client import Link
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Login, Role
from tests.contract.bus_table import DENIAL_WAIT, KEYS, MEMBERS, PREFIX, ROWS, STOP, VERBS, answered, asked, drain, raw
from tests.ports import free_endpoint
from tests.waiting import HANG, wait_until


@pytest.fixture(scope="module")
def station() -> Iterator[tuple[BusSettings, BusAccess, Bus]]:
    settings = BusSettings(endpoint=free_endpoint())
    own, *logins = (Login(role.value, new_password(), role) for role in (Role.SERVICE, *MEMBERS))
    held = (
        Login("arm", new_password(), Role.ROBOT, only="puma560"),
        Login("left", new_password(), Role.TRACKER, only="left"),
    )
    access = BusAccess(own, (*logins, *held))
    bus = listen_on_bus(settings, access)
    yield settings, access, bus
    bus.close()


@pytest.fixture(params=MEMBERS)
def member(request: pytest.FixtureRequest, station: tuple[BusSettings, BusAccess, Bus]) -> Iterator[tuple[Login, Bus]]:
    """A login of each role and its session."""
    settings, access, _ = station
    login = access.login(request.param)
    bus = open_bus(settings, login)
    yield login, bus
    bus.close()


def allowed(login: Login, verb: str) -> set[str]:
    """Return the keys on which the table gives a login's role a verb."""
    column = ROWS[0].index(login.role)
    return {key for key, row in zip(KEYS, ROWS[1:], strict=True) if verb in map(VERBS.get, row[column])}


def test_the_table_has_every_key_and_every_role() -> None:
    keys = Keys(PREFIX)
    named = {value for value in vars(keys).values() if value != PREFIX and "*" not in value}
    named |= {keys.samples("glove"), keys.feedback("glove"), keys.job("job-1"), keys.object("paper")}
    named |= {make("puma560") for make in (keys.setpoint, keys.state, keys.reset)}
    assert named | {f"{PREFIX}/elsewhere"} == set(KEYS)
    assert ROWS[0][1:] == list(MEMBERS)
    assert set(MEMBERS) == set(Role) - {Role.SERVICE, Role.ROUTER}


@pytest.mark.parametrize("role", MEMBERS)
@pytest.mark.parametrize("verb", VERBS.values())
def test_what_is_granted_is_the_table(role: Role, verb: str) -> None:
    login = Login(role.value, "", role)
    patterns = [zenoh.KeyExpr(key) for key in granted(login, PREFIX).get(verb, [])]
    assert {key for key in KEYS if any(p.includes(zenoh.KeyExpr(key)) for p in patterns)} == allowed(login, verb)


def test_a_part_shows_that_it_is_alive_under_its_own_kind_alone(
    station: tuple[BusSettings, BusAccess, Bus], member: tuple[Login, Bus]
) -> None:
    (_, _, service), (login, bus) = station, member
    kinds = ("executor", "robot", "tracker")
    seen: queue.Queue[str] = queue.Queue()
    handle = service.watch(f"{PREFIX}/alive/**", lambda key, alive: seen.put(key) if alive else None)
    for kind in kinds:
        bus.announce(f"{PREFIX}/alive/{kind}/it")
    came = {seen.get(timeout=HANG)} if login.role in kinds else set()
    time.sleep(0.1)  # whatever else would come, in threads of their own
    came |= {seen.get() for _ in range(seen.qsize())}
    assert came == {f"{PREFIX}/alive/{kind}/it" for kind in kinds if kind == login.role}
    handle.close()


def test_puts_arrive_from_those_who_may(station: tuple[BusSettings, BusAccess, Bus], member: tuple[Login, Bus]) -> None:
    (_, _, service), (login, bus) = station, member
    heard: queue.Queue[tuple[str, bytes]] = queue.Queue()
    handles = [service.subscribe(key, lambda key, payload: heard.put((key, payload))) for key in KEYS]
    may = allowed(login, "put")
    for key in may:  # until its session knows who listens
        while not any(first == key for first, _ in drain(heard)):
            bus.publish(key, b"first")
    for key in KEYS:
        bus.publish(key, b"mine")
    for key in may:
        bus.publish(key, b"last")
    came = set(drain(heard))
    while not {(key, b"last") for key in may} <= came:  # every subscription is served by a thread of its own
        came.add(heard.get(timeout=HANG))
    came |= set(drain(heard))
    assert {key for key, payload in came if payload == b"mine"} == may
    assert {key for key, _ in came} == may
    for handle in handles:
        handle.close()


def test_only_those_hear_who_may(station: tuple[BusSettings, BusAccess, Bus], member: tuple[Login, Bus]) -> None:
    (_, _, service), (login, bus) = station, member
    may, heard, begun = allowed(login, "subscribe"), queue.Queue[str](), set[str]()
    for key in KEYS:
        bus.subscribe(key, lambda key, payload: heard.put(key) if payload == b"theirs" else begun.add(key))
    for key in may:
        while key not in begun:  # until its subscription has arrived
            service.publish(key, b"begin")
            time.sleep(0.01)
    for key in KEYS:
        service.publish(key, b"theirs")
    came = {heard.get(timeout=HANG) for _ in may}
    time.sleep(0.1)  # whatever else would come, in threads of their own
    while not heard.empty():
        came.add(heard.get())
    assert came == may


def test_only_those_answer_who_may(station: tuple[BusSettings, BusAccess, Bus], member: tuple[Login, Bus]) -> None:
    (_, _, service), (login, bus) = station, member
    for key in KEYS:
        bus.serve(key, lambda _: b"me")
    answered = {key for key in KEYS if asked(service, key)}
    while not allowed(login, "serve") <= answered:  # its declarations may still be under way
        answered |= {key for key in KEYS if asked(service, key)}
    assert answered == allowed(login, "serve")


def test_what_a_tracker_keeps_is_had_from_it(station: tuple[BusSettings, BusAccess, Bus]) -> None:
    settings, access, service = station
    key, sent = f"{PREFIX}/trackers/glove/samples", [b"0", b"1", b"2"]
    with Link(settings.endpoint, login=access.login(Role.TRACKER)) as link:
        publisher = link.publisher(key)
        for payload in sent:
            publisher.put(payload)
        wait_until(lambda: service.history(key) == sent, "the service has what was sent before it asked")


def test_only_those_are_answered_who_may_ask(
    station: tuple[BusSettings, BusAccess, Bus], member: tuple[Login, Bus]
) -> None:
    (_, _, service), (login, bus) = station, member
    handles = [service.serve(key, lambda _: b"the service") for key in KEYS]
    answers: dict[str, bool] = {}
    may = allowed(login, "ask")

    def ask(key: str) -> None:
        answers[key] = asked(bus, key, HANG if key in may else DENIAL_WAIT)

    threads = [threading.Thread(target=ask, args=(key,)) for key in KEYS]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for handle in handles:
        handle.close()
    assert {key for key, answer in answers.items() if answer} == may


def test_nobody_deletes(station: tuple[BusSettings, BusAccess, Bus], member: tuple[Login, Bus]) -> None:
    (settings, _, service), (login, _) = station, member
    heard: queue.Queue[tuple[str, bytes]] = queue.Queue()
    handles = [service.subscribe(key, lambda key, payload: heard.put((key, payload))) for key in KEYS]
    session = raw(settings, login)
    for key in KEYS:
        session.delete(key)
    last = sorted(allowed(login, "put"))[0]
    while not (came := drain(heard)):
        session.put(last, b"last")
    assert set(came) == {(last, b"last")}
    session.close()
    for handle in handles:
        handle.close()


def test_a_stop_reaches_the_executor_from_everybody_and_cannot_be_swallowed(
    station: tuple[BusSettings, BusAccess, Bus],
) -> None:
    settings, access, service = station
    executor, viewer = (raw(settings, access.login(role)) for role in (Role.EXECUTOR, Role.VIEWER))
    swallowed: list[int] = []
    impostor = viewer.declare_queryable(STOP, lambda query: swallowed.append(1), complete=True)
    reached: queue.Queue[str] = queue.Queue()

    def answer(query: Any) -> None:
        with query:
            reached.put("asked")
            query.reply(STOP, b"the executor")

    queryable = executor.declare_queryable(STOP, answer)
    while not asked(service, STOP):
        pass
    for _ in range(20):
        assert service.ask(STOP, timeout=HANG) == b"the executor"
    assert not swallowed
    told: queue.Queue[bytes] = queue.Queue()
    subscriber = executor.declare_subscriber(STOP, lambda sample: told.put(sample.payload.to_bytes()))
    while told.empty():  # until the station knows who listens
        service.publish(STOP, b"")
        time.sleep(0.01)
    for role in (Role.ROBOT, Role.TRACKER, Role.OPERATOR, Role.VIEWER):
        bus = open_bus(settings, access.login(role))
        bus.publish(STOP, role.value.encode())
        while (payload := told.get(timeout=HANG)) == b"":
            pass
        assert payload == role.value.encode()
        assert bus.ask(STOP, timeout=HANG) == b"the executor"
        bus.close()
    for declared in (impostor, queryable, subscriber):
        declared.undeclare()
    executor.close()
    viewer.close()


def test_a_tracker_that_is_held_to_one_name_is_no_other(station: tuple[BusSettings, BusAccess, Bus]) -> None:
    settings, access, service = station
    heard: queue.Queue[str] = queue.Queue()
    handle = service.subscribe(f"{PREFIX}/trackers/*/samples", lambda key, _: heard.put(key))
    bus = open_bus(settings, access.logins[-1])
    answering = service.serve(f"{PREFIX}/recorder/status", lambda _: b"")
    for _ in range(2):
        bus.publish(f"{PREFIX}/trackers/right/samples", b"hijacked")
        bus.publish(f"{PREFIX}/trackers/left/samples", b"mine")
        assert heard.get(timeout=HANG) == f"{PREFIX}/trackers/left/samples"
        bus.ask(f"{PREFIX}/recorder/status")  # from now on its session knows who hears it, and sends to nobody else
    bus.close()
    answering.close()
    handle.close()


def test_a_driver_that_is_held_to_its_arm_takes_part_in_everything_that_an_arm_does(
    station: tuple[BusSettings, BusAccess, Bus],
) -> None:
    settings, access, service = station
    keys, heard = Keys(PREFIX), queue.Queue[str]()
    driver, executor = open_bus(settings, access.logins[-2]), open_bus(settings, access.login(Role.EXECUTOR))
    service.watch(keys.all_alive, lambda key, _: heard.put(key))
    executor.watch(keys.alive("robot", "puma560"), lambda key, _: heard.put(key))
    driver.announce(keys.alive("robot", "puma560"))
    assert {heard.get(timeout=HANG), heard.get(timeout=HANG)} == {keys.alive("robot", "puma560")}
    driver.serve(keys.reset("puma560"), lambda _: b"done")
    executor.subscribe(keys.state("puma560"), lambda key, _: heard.put(key))
    driver.subscribe(keys.setpoint("puma560"), lambda key, _: heard.put(key))
    wait_until(lambda: answered(executor, keys.reset("puma560")), "its queryable is known")
    for _ in range(2):  # the second ones when the sessions know who hears them
        for bus, key in ((driver, keys.state("puma560")), (executor, keys.setpoint("puma560"))):
            bus.publish(key, b"")
            assert heard.get(timeout=HANG) == key
        assert executor.ask(keys.reset("puma560"), timeout=HANG) == b"done"
    driver.close()
    executor.close()


@pytest.mark.parametrize("login", [None, Login("viewer", "guessed", Role.VIEWER), Login("root", "", Role.EXECUTOR)])
def test_without_the_right_password_nobody_comes_in(
    station: tuple[BusSettings, BusAccess, Bus], login: Login | None
) -> None:
    settings = BusSettings(endpoint=station[0].endpoint, connect_timeout=0.5)
    with pytest.raises(Unreachable, match="is the login one of its own"):
        open_bus(settings, login)
