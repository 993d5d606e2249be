"""A program is in control of the arm for as long as it lives, and gives control to whoever asks for it."""

from collections.abc import Iterator

import pytest

from teachpath.executor.lease import ControlLease
from teachpath.io.wire import decode_lease_request, encode_lease
from teachpath_client import ClientError, Station
from teachpath_client.errors import Refused
from tests.contract.desk import Desk
from tests.waiting import wait_until


class Leases:
    """The executor's lease, on a clock of its own."""

    def __init__(self) -> None:
        self.now = 0
        self.lease = ControlLease(lambda: self.now)

    def answer(self, payload: bytes) -> bytes:
        return encode_lease(self.lease.answer(decode_lease_request(payload)))

    def lapse(self) -> None:
        """Let so much time pass that a lease without another beat is over."""
        self.now += 10**10


@pytest.fixture
def leases(desk: Desk) -> Iterator[Leases]:
    leases = Leases()
    handle = desk.station.bus.serve(desk.station.keys.executor_lease, leases.answer)
    yield leases
    handle.close()


@pytest.fixture
def ada(port: int, leases: Leases) -> Iterator[Station]:
    with Station(f"http://127.0.0.1:{port}", operator="Ada") as station:
        yield station


@pytest.fixture
def bea(port: int, leases: Leases) -> Iterator[Station]:
    with Station(f"http://127.0.0.1:{port}", operator="Bea") as station:
        yield station


def holds(station: Station, name: str) -> None:
    wait_until(lambda: station.get_lease().holder == name, f"{name!r} holds control")


def test_control_is_given_back(ada: Station) -> None:
    with ada.control():
        held = ada.get_lease()
        assert (held.holder, held.hold_when_lost) == ("Ada", True)
        with ada.control():  # the same
            pass
        assert ada.get_lease().holder == "Ada"
    assert ada.get_lease().holder == ""


def test_nobody_takes_control_from_somebody_else(ada: Station, bea: Station) -> None:
    with ada.control(), pytest.raises(Refused, match="Ada is in control"), bea.control():
        pass
    assert ada.get_lease().holder == ""


def test_whoever_asks_gets_control(ada: Station, bea: Station) -> None:
    with ada.control():
        bea.set_lease(bea.claim_lease("Bea", ask=True).token)
        holds(bea, "Bea")
        assert bea.act_on_lease("beat").holder == "Bea"
    assert bea.act_on_lease("release").holder == ""


def test_control_that_lapsed_is_taken_again(ada: Station, leases: Leases) -> None:
    with ada.control():
        leases.lapse()
        holds(ada, "Ada")
        assert leases.lease.pop_lost_holder() == "Ada"
    assert ada.get_lease().holder == ""


def test_a_program_that_is_broken_off_lets_control_lapse_so_that_the_arm_is_held(ada: Station, leases: Leases) -> None:
    with pytest.raises(KeyboardInterrupt), ada.control():
        raise KeyboardInterrupt
    assert ada.get_lease().holder == "Ada"
    leases.lapse()
    assert ada.get_lease().holder == ""
    assert leases.lease.pop_lost_holder() == "Ada"


def test_a_refusal_gives_control_back(ada: Station) -> None:
    with pytest.raises(ClientError, match="refused"), ada.control():
        raise ClientError("refused")
    assert ada.get_lease().holder == ""
