"""People in virtual time: who signs in, for how long, and how often somebody may guess."""

import pytest

from teachpath.access.access import Access
from teachpath.access.attempts import MAX_FROM_ADDRESS, MAX_KEYS, MAX_OF_NAME, WINDOW, Attempts
from teachpath.access.memory_people import MemoryPeople
from teachpath.access.memory_tokens import MemoryTokens
from teachpath.access.passwords import hash_password, is_password
from teachpath.access.settings import AuthSettings
from teachpath.errors import NotSignedIn, TooManyAttempts, UnusableInput
from teachpath.records import Capability, Person

NS = 10**9
PASSWORD = "four words put together"
STORED_HASH = hash_password(PASSWORD, "anna")  # it takes time by intention: once for all tests
CLIENT_ADDRESS = "127.0.0.1"


class Station:
    """People who sign in, on a clock of their own."""

    def __init__(self) -> None:
        self.now = 10**18
        self.people = MemoryPeople()
        self.people.put(Person("anna", (Capability.TEACH,), STORED_HASH, self.now, self.now))
        settings = AuthSettings("token", session_idle=600.0, session_length=3600.0)
        self.access = Access(settings, MemoryTokens(), self.people, lambda: self.now)
        self.access.refresh()

    def sign_in(self) -> str:
        secret, subject = self.access.sessions.sign_in("anna", PASSWORD, CLIENT_ADDRESS)
        assert (subject.name, Capability.TEACH in subject.capabilities) == ("anna", True)
        return secret

    def name(self, secret: str) -> str:
        return self.access.subject([], secret).name


@pytest.fixture
def station() -> Station:
    return Station()


def test_a_session_is_new_each_time_and_says_who_it_is(station: Station) -> None:
    first, second = station.sign_in(), station.sign_in()
    assert first != second
    assert station.name(first) == station.name(second) == "anna"
    with pytest.raises(NotSignedIn, match="has ended"):
        station.name("chosen-by-somebody-else")


def test_a_session_ends_when_nothing_is_asked_and_at_last_anyway(station: Station) -> None:
    idle = station.sign_in()
    station.now += 600 * NS
    with pytest.raises(NotSignedIn, match="your session has ended"):
        station.name(idle)
    busy = station.sign_in()
    for _ in range(8):
        station.now += 400 * NS
        assert station.name(busy) == "anna"
        station.access.refresh()
    station.now += 400 * NS
    with pytest.raises(NotSignedIn):
        station.name(busy)
    station.access.refresh()
    assert station.people.sessions() == []


def test_a_session_outlives_a_restart_of_the_service(station: Station) -> None:
    secret = station.sign_in()
    settings = AuthSettings("token", session_idle=600.0, session_length=3600.0)
    again = Access(settings, MemoryTokens(), station.people, lambda: station.now)
    again.refresh()
    assert again.subject([], secret).name == "anna"


@pytest.mark.parametrize("how", ["signed out", "removed", "another password"])
def test_what_was_opened_ends_with_the_session(station: Station, how: str) -> None:
    secret, other, ended = station.sign_in(), station.sign_in(), list[str]()
    station.access.call_at_end(station.access.subject([], secret), lambda: ended.append(how))
    station.access.refresh()
    assert ended == []
    station.now += 1
    if how == "signed out":
        station.access.sessions.sign_out(secret)
        assert station.name(other) == "anna"
    elif how == "removed":
        station.people.remove("anna")
    else:
        station.people.put(Person("anna", (Capability.TEACH,), STORED_HASH, 0, station.now))
    station.access.refresh()
    assert ended == [how]
    with pytest.raises(NotSignedIn):
        station.name(secret)


def test_a_wrong_name_and_a_wrong_password_are_answered_alike(station: Station) -> None:
    sentences = set()
    for name, password in (("anna", "wrong"), ("nobody", PASSWORD), ("", ""), ("anna", ""), ("Anna", PASSWORD)):
        with pytest.raises(NotSignedIn) as found:
            station.access.sessions.sign_in(name, password, CLIENT_ADDRESS)
        sentences.add(str(found.value))
    assert len(sentences) == 1


def test_nobodys_password_is_as_much_work_as_anybodys() -> None:
    from teachpath.access import passwords

    parameters = [kept.rpartition("$")[0].rpartition("$")[0] for kept in (STORED_HASH, passwords._NOBODYS_HASH)]
    assert parameters[0] == parameters[1]
    assert not is_password(PASSWORD, None)


def test_passwords_are_checked_whole_and_however_they_were_typed() -> None:
    kept = hash_password("Ein schöner Würfel", "anna")
    assert is_password("Ein scho\u0308ner Wu\u0308rfel", kept)
    assert not is_password("Ein schöner Würfe", kept)
    assert not is_password("ein schöner würfel", kept)
    longest = "a" * 256
    assert is_password(longest, hash_password(longest, "anna"))
    assert not is_password(longest + "b", hash_password(longest, "anna"))


@pytest.mark.parametrize("password", ["", "short", "x" * 257, "annabelle-lee"])
def test_a_weak_password_is_refused(password: str) -> None:
    with pytest.raises(UnusableInput, match="10 to 256 characters"):
        hash_password(password, "Annabelle-Lee")


class Guesser:
    """Somebody who guesses, on a clock of his own."""

    def __init__(self) -> None:
        self.now, self.wait = 0.0, 0.0
        self.attempts = Attempts(lambda: self.now)

    def tried(self, name: str, address: str = "a", *, most: int = 1000) -> int:
        """Return how many attempts are let through before the first that is not."""
        for count in range(most):
            try:
                self.attempts.begin(name, address)
            except TooManyAttempts as error:
                self.wait = error.wait
                return count
        return most


def test_guessing_is_slow_by_name_and_by_address() -> None:
    guesser = Guesser()
    assert guesser.tried("anna") == MAX_OF_NAME
    assert guesser.tried("anna", "b") == MAX_OF_NAME  # who sits elsewhere is not locked out by it
    assert sum(guesser.tried(f"name-{i}") for i in range(20)) == MAX_FROM_ADDRESS - MAX_OF_NAME
    assert 0 < guesser.wait <= WINDOW
    guesser.now += guesser.wait
    assert guesser.tried("anna") == MAX_OF_NAME


def test_guessing_from_one_network_of_ipv6_is_guessing_from_one_address() -> None:
    guesser = Guesser()
    for i in range(MAX_OF_NAME):
        assert guesser.tried("anna", f"fe80::{i}:1", most=1) == 1
    assert guesser.tried("anna", "fe80::ffff:1") == 0
    assert guesser.tried("anna", "fe80:0:0:1::1", most=1) == 1
    assert guesser.tried("anna", "::ffff:10.0.0.7") == MAX_OF_NAME
    assert guesser.tried("anna", "10.0.0.7") == 0


def test_who_mistyped_and_then_signs_in_is_free_again() -> None:
    guesser = Guesser()
    for _ in range(MAX_OF_NAME - 1):
        guesser.attempts.begin("anna", "a")
    guesser.attempts.begin("anna", "a")
    guesser.attempts.succeed("anna", "a")
    assert guesser.tried("anna") == MAX_OF_NAME


def test_guessing_from_many_addresses_takes_no_memory_without_end() -> None:
    guesser = Guesser()
    for i in range(MAX_KEYS):
        guesser.attempts.begin(f"n{i}", f"a{i}")
    assert len(guesser.attempts._failures) <= MAX_KEYS
