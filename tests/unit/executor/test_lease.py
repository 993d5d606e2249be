import pytest

from teachpath.errors import Conflict, UnusableInput
from teachpath.executor.lease import DEFAULT_BEAT_INTERVAL, GRANT_DELAY, ControlLease
from teachpath.io import wire
from teachpath.records import LeaseRequest
from teachpath_proto.control import LeaseAction


class Desk:
    """A lease on a clock that the test turns."""

    def __init__(self) -> None:
        self.now = 0.0
        self.lease = ControlLease(lambda: round(self.now * 1e9))

    def say(self, action: str, name: str = "", token: str = "", **more: object) -> str:
        return self.lease.answer(LeaseRequest(LeaseAction(action), name, token, **more)).token  # type: ignore[arg-type]

    def holder(self) -> str:
        return self.lease.public_view().holder


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_without_a_lease_everybody_may_command(desk: Desk) -> None:
    assert desk.lease.require("", "a script") == "a script"


def test_one_at_a_time_and_its_token_is_its_own(desk: Desk) -> None:
    token = desk.say("acquire", "Ada")
    assert desk.lease.require(token, "") == "Ada"
    assert desk.lease.public_view().token == ""
    for use in (lambda: desk.say("acquire", "Bea"), lambda: desk.lease.require("", "Bea")):
        with pytest.raises(Conflict, match="Ada is in control"):
            use()
    desk.say("release", token=token)
    assert desk.holder() == ""
    with pytest.raises(Conflict, match="this hold on control is over"):
        desk.lease.require(token, "")


def test_it_lapses_without_beats_and_not_with_them(desk: Desk) -> None:
    token = desk.say("acquire", "Ada")
    for _ in range(5):
        desk.now += 0.9 * DEFAULT_BEAT_INTERVAL
        desk.say("beat", token=token)
    assert desk.holder() == "Ada"
    desk.now += 1.1 * DEFAULT_BEAT_INTERVAL
    assert desk.holder() == ""
    assert desk.lease.pop_lost_holder() == ""  # she did not ask for that


def test_a_lost_holder_is_told_once(desk: Desk) -> None:
    desk.say("acquire", "Ada", hold_when_lost=True)
    desk.now += 1.1 * DEFAULT_BEAT_INTERVAL
    assert [desk.lease.pop_lost_holder(), desk.lease.pop_lost_holder()] == ["Ada", ""]


@pytest.mark.parametrize("answer", ["release", "keep", "nothing"])
def test_who_asks_gets_it_unless_the_holder_keeps_it(desk: Desk, answer: str) -> None:
    ada = desk.say("acquire", "Ada", seconds=60.0)
    bea = desk.say("ask", "Bea", seconds=8.0)
    assert (desk.lease.public_view().asking, desk.lease.public_view().granted_in) == ("Bea", GRANT_DELAY)
    with pytest.raises(Conflict, match="Bea asks for control already"):
        desk.say("ask", "Cem")
    with pytest.raises(Conflict, match="Ada is in control"):
        desk.lease.require(bea, "")  # not yet
    if answer != "nothing":
        desk.say(answer, token=ada)
    for _ in range(2):
        desk.now += 0.55 * GRANT_DELAY
        if answer != "keep":
            desk.say("beat", token=bea)
    assert desk.holder() == ("Ada" if answer == "keep" else "Bea")
    if answer == "keep":
        with pytest.raises(Conflict, match="kept"):
            desk.say("beat", token=bea)


def test_who_asks_and_goes_away_gets_nothing(desk: Desk) -> None:
    ada = desk.say("acquire", "Ada", seconds=60.0)
    desk.say("ask", "Bea")
    desk.now += 1.1 * GRANT_DELAY
    assert desk.holder() == "Ada"
    desk.say("beat", token=ada)


@pytest.mark.parametrize(
    ("request_", "sentence"),
    [
        (LeaseRequest(LeaseAction.ACQUIRE, " "), "under a name"),
        (LeaseRequest(LeaseAction.ACQUIRE, "x" * 65), "more than 64"),
        (LeaseRequest(LeaseAction.ACQUIRE, "a\nb"), "unprintable"),
        (LeaseRequest(LeaseAction.ACQUIRE, "Ada", seconds=float("nan")), "seconds should be finite, got nan"),
        (LeaseRequest(LeaseAction.ACQUIRE, "Ada", seconds=1e9), "at most 60"),
    ],
)
def test_an_unusable_word_is_refused_on_the_wire(request_: LeaseRequest, sentence: str) -> None:
    with pytest.raises(UnusableInput, match=sentence):
        wire.decode_lease_request(wire.encode_lease_request(request_))
