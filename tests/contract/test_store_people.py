"""Tokens, people and their sessions are kept."""

from dataclasses import replace

import pytest

from teachpath.errors import Conflict, NotFound
from teachpath.io.store.store import Store
from teachpath.records import (
    AccessToken,
    Capability,
    Person,
    Session,
)
from tests.contract.stores import Open


def a_token(name: str, digest: str, **changes: int) -> AccessToken:
    return replace(AccessToken(name, (Capability.VIEW, Capability.OPERATE), digest, 10, 100), **changes)  # type: ignore[arg-type]


def test_tokens_are_kept_used_and_revoked(open_: Open) -> None:
    tokens = open_().access_tokens
    first, second = a_token("cell-3", "a" * 64), a_token("glove", "b" * 64, created_ns=11)
    tokens.add(first)
    tokens.add(second)
    tokens.note_use({first.digest: 20})
    assert open_().access_tokens.all() == [replace(first, used_ns=20), second]
    assert tokens.revoke("cell-3", 30) == replace(first, used_ns=20, revoked_ns=30)
    with pytest.raises(NotFound, match="no token 'cell-3' that holds; known: glove"):
        tokens.revoke("cell-3", 31)
    with pytest.raises(NotFound, match="known: none"):
        tokens.revoke("glove", 100)  # it has expired


def test_a_name_has_one_token_that_holds(store: Store) -> None:
    tokens = store.access_tokens
    tokens.add(a_token("cell-3", "a" * 64))
    with pytest.raises(Conflict, match="there is a token 'cell-3' already"):
        tokens.add(a_token("cell-3", "b" * 64, created_ns=99))
    tokens.add(a_token("cell-3", "c" * 64, created_ns=100, expires_ns=200))  # the first has expired
    tokens.revoke("cell-3", 120)
    tokens.add(a_token("cell-3", "d" * 64, created_ns=130, expires_ns=200))
    assert [token.digest[0] for token in tokens.all()] == ["a", "c", "d"]


def test_a_person_of_a_provider_keeps_the_first_name_and_has_the_last_roles(store: Store) -> None:
    def anna(name: str, *roles: Capability, subject: str = "1") -> Person:
        return Person(name, roles, "", 5, 5, "https://lab.example", subject)

    people = store.people
    assert people.register(anna("anna", Capability.TEACH)) == anna("anna", Capability.TEACH)
    again = anna("anna", Capability.OPERATE)
    assert people.register(anna("otto", Capability.OPERATE)) == again
    assert people.all() == [again]
    with pytest.raises(Conflict, match="taken by a person or a token"):
        people.register(anna("anna", Capability.TEACH, subject="2"))
    with pytest.raises(Conflict, match="has no password here"):
        people.change_password("anna", "hash", 6)


def test_people_are_kept_with_their_sessions_and_go_with_them(open_: Open) -> None:
    people = open_().people
    anna, otto = (Person(name, (Capability.TEACH,), f"hash of {name}", 5, 5) for name in ("anna", "otto"))
    people.add(otto)
    people.add(anna)
    with pytest.raises(Conflict, match="the name 'anna' is taken"):
        people.add(anna)
    sessions = [Session(digest * 64, name, 6, 6) for digest, name in (("a", "anna"), ("b", "anna"), ("c", "otto"))]
    for session in sessions:
        people.begin_session(session)
    people.note_use({"a" * 64: 9})
    people.end_sessions(["b" * 64, "d" * 64])
    again = open_().people
    assert again.all() == [anna, otto]
    assert sorted(again.sessions(), key=lambda s: s.digest) == [replace(sessions[0], used_ns=9), sessions[2]]
    people.change_password("anna", "another", 10)
    assert again.all()[0] == replace(anna, password_hash="another", changed_ns=10)
    assert again.sessions() == [sessions[2]]
    people.remove("otto")
    assert again.sessions() == []
    for act in (lambda: people.remove("otto"), lambda: people.change_password("otto", "x", 1)):
        with pytest.raises(NotFound, match="no person 'otto'; known: anna"):
            act()
    with pytest.raises(NotFound):
        people.begin_session(sessions[2])


def test_a_name_is_of_a_person_or_of_a_token_and_of_one_alone(store: Store) -> None:
    store.people.add(Person("anna", (), "hash", 1, 1))
    with pytest.raises(Conflict, match="a person has the name 'anna'"):
        store.access_tokens.add(a_token("anna", "a" * 64))
    store.access_tokens.add(a_token("cell-3", "b" * 64))
    with pytest.raises(Conflict, match="taken by a person or a token"):
        store.people.add(Person("cell-3", (), "hash", 50, 50))
    for alike in ("Cell-3", "ANNA"):  # which a journal would not tell apart
        with pytest.raises(Conflict, match="taken by"):
            store.people.add(Person(alike, (), "hash", 50, 50))
        with pytest.raises(Conflict, match=r"'(cell-3|anna)'"):
            store.access_tokens.add(a_token(alike, "c" * 64))
        with pytest.raises(Conflict, match="taken by"):
            store.people.register(Person(alike, (), "", 50, 50, "https://lab.example", "7"))
    store.access_tokens.revoke("cell-3", 60)
    store.people.add(Person("Cell-3", (), "hash", 70, 70))
