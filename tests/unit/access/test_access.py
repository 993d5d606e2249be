"""Who asks, in virtual time: tokens hold until they are revoked or expire, and what they opened ends with them."""

from dataclasses import replace

import pytest

from teachpath.access.access import UNAUTHENTICATED_SUBJECT, Access
from teachpath.access.loopback import host_of, is_loopback
from teachpath.access.memory_people import MemoryPeople
from teachpath.access.memory_tokens import MemoryTokens
from teachpath.access.settings import AuthSettings
from teachpath.access.tokens import DAY_NS, digest_of, new_token
from teachpath.errors import NotSignedIn
from teachpath.records import ROLES, Capability, capabilities_of

MINUTE_NS = 60 * 10**9


class Station:
    """A table of tokens, and who reads it, on a clock of their own."""

    def __init__(self, mode: str = "token") -> None:
        self.now = 10**18
        self.table = MemoryTokens()
        self.access = Access(AuthSettings(mode), self.table, MemoryPeople(), lambda: self.now)  # type: ignore[arg-type]

    def make(self, name: str, *roles: Capability, days: float = 1.0) -> str:
        token, kept = new_token(name, roles, now_ns=self.now, days=days)
        self.table.put(kept)
        return token

    def asks(self, token: str) -> str:
        return self.access.subject([f"Bearer {token}"]).name


@pytest.fixture
def station() -> Station:
    return Station()


def test_a_token_says_who_asks_and_what_he_may(station: Station) -> None:
    token = station.make("cell-3", Capability.OPERATE, Capability.TEACH)
    with pytest.raises(NotSignedIn, match="not known here, or not yet"):
        station.asks(token)
    station.access.refresh()
    subject = station.access.subject([f"Bearer {token}"])
    assert (subject.name, subject.credential) == ("cell-3", digest_of(token))
    assert subject.capabilities == ROLES[Capability.OPERATE] | ROLES[Capability.TEACH]


def test_a_token_expires_to_the_moment(station: Station) -> None:
    token = station.make("cell-3", Capability.VIEW, days=2.0)
    station.access.refresh()
    station.now += 2 * DAY_NS - 1
    assert station.asks(token) == "cell-3"
    station.now += 1
    with pytest.raises(NotSignedIn, match="token cell-3 expired on 2001"):
        station.asks(token)


def test_use_is_noted_once_a_minute(station: Station) -> None:
    token = station.make("cell-3", Capability.VIEW)

    def used() -> int:
        station.access.refresh()
        (kept,) = station.table.all()
        return kept.used_ns

    assert used() == 0
    station.asks(token)
    first = station.now
    assert used() == first
    station.now += MINUTE_NS
    station.asks(token)
    assert used() == first
    station.now += 1
    station.asks(token)
    assert used() == station.now


@pytest.mark.parametrize("how", ["revoked", "expired", "removed"])
def test_what_was_opened_ends_with_the_token(station: Station, how: str) -> None:
    ended: list[str] = []
    subjects = {}
    for name in ("one", "other"):
        token = station.make(name, Capability.VIEW, days=1.0 if name == "one" else 9.0)
        station.access.refresh()
        subjects[name] = station.access.subject([f"Bearer {token}"])
        station.access.call_at_end(subjects[name], lambda name=name: ended.append(name))  # type: ignore[misc]
    forget = station.access.call_at_end(subjects["one"], lambda: ended.append("forgotten"))
    forget()
    station.access.refresh()
    assert ended == []
    digest = subjects["one"].credential
    if how == "revoked":
        station.table.put(replace(station.table.tokens[digest], revoked_ns=station.now))
    elif how == "expired":
        station.now += DAY_NS
    else:
        del station.table.tokens[digest]
    station.access.refresh()
    assert ended == ["one"]


def test_a_station_that_does_not_ask_lets_everybody_do_everything() -> None:
    station = Station("none")
    for authorization in ([], ["Bearer nonsense"], ["a", "b"]):
        assert station.access.subject(authorization) == UNAUTHENTICATED_SUBJECT
    assert station.access.notes() == []


def test_it_is_said_when_no_token_holds(station: Station) -> None:
    station.access.refresh()
    assert "teachpath person add NAME --role administer" in station.access.notes()[0]
    station.make("cell-3", Capability.VIEW)
    station.access.refresh()
    assert station.access.notes() == []
    station.now += DAY_NS
    assert station.access.notes()


def test_tokens_are_random_and_kept_as_a_hash() -> None:
    made = [new_token("t", (Capability.VIEW,), now_ns=0, days=1.0) for _ in range(100)]
    assert len({token for token, _ in made}) == 100
    for token, kept in made:
        assert kept.digest == digest_of(token)
        assert token not in repr(kept)
        assert kept.digest not in repr(kept)


def test_who_demonstrates_does_not_run_the_arm_and_who_runs_it_does_not_change_paths() -> None:
    assert Capability.OPERATE not in capabilities_of([Capability.DEMONSTRATE, Capability.TEACH])
    assert Capability.TEACH not in capabilities_of([Capability.OPERATE])
    assert all(role in can and Capability.VIEW in can for role, can in ROLES.items())
    assert ROLES[Capability.ADMINISTER] == set(Capability)


@pytest.mark.parametrize(
    ("authority", "host", "loopback"),
    [
        ("127.0.0.1:8765", "127.0.0.1", True),
        ("LOCALHOST", "LOCALHOST", True),
        ("[::1]:8765", "[::1]", True),
        ("[::ffff:127.0.0.1]", "[::ffff:127.0.0.1]", True),
        ("127.9.9.9", "127.9.9.9", True),
        ("[::ffff:10.0.0.1]:80", "[::ffff:10.0.0.1]", False),
        ("localhost.evil.example:1", "localhost.evil.example", False),
        ("127.0.0.1.evil.example", "127.0.0.1.evil.example", False),
        ("0.0.0.0:8765", "0.0.0.0", False),
        ("2130706433", "2130706433", False),
        ("0x7f.1", "0x7f.1", False),
        ("", "", False),
        ("[::1", "[", False),
    ],
)
def test_only_what_is_loopback_for_sure_is(authority: str, host: str, loopback: bool) -> None:
    assert host_of(authority).rstrip() == host or not loopback
    assert is_loopback(host_of(authority)) is loopback
