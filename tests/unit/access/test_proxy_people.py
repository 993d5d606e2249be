"""Whom a proxy brings has the roles of the groups that it tells, and no others."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath.access.access import UNAUTHENTICATED_SUBJECT, Access
from teachpath.access.memory_people import MemoryPeople
from teachpath.access.memory_tokens import MemoryTokens
from teachpath.access.proxy_people import Forwarded, require_roles
from teachpath.access.settings import AuthSettings, ProxySettings
from teachpath.errors import NotSignedIn, UnusableSettings
from teachpath.records import ROLES, Capability

ROLE_GROUPS = {Capability.VIEW: "lab", Capability.TEACH: "teachers", Capability.OPERATE: "cell-3-operators"}
SETTINGS = ProxySettings(**{role.value: (group,) for role, group in ROLE_GROUPS.items()})
names = st.text(st.characters(codec="utf-8", categories=("L", "N")), min_size=1, max_size=12)


def access(settings: ProxySettings = SETTINGS) -> Access:
    return Access(AuthSettings("proxy"), MemoryTokens(), MemoryPeople(), proxy=settings)


@given(
    st.lists(st.sampled_from(sorted(ROLE_GROUPS)), unique=True), st.lists(names), st.sampled_from([",", ", ", " , ,"])
)
def test_roles_are_those_of_the_groups_whatever_else_somebody_is_in(
    roles: list[Capability], others: list[str], between: str
) -> None:
    others = [each for each in others if each not in ROLE_GROUPS.values()]
    told = between.join([ROLE_GROUPS[role] for role in roles] + others)
    subject = access().subject([], forwarded=Forwarded("anna", told))
    assert subject.capabilities == frozenset().union(*(ROLES[role] for role in roles))
    assert subject.groups == (*(ROLE_GROUPS[role] for role in roles), *others)


@pytest.mark.parametrize("told", ["", ",", "Lab", "lab2", "la", "lab/teachers", "lab;teachers", "*x"])
def test_who_is_in_no_group_that_is_named_has_no_role(told: str) -> None:
    subject = access().subject([], forwarded=Forwarded("anna", told))
    assert subject.capabilities == frozenset()
    sentence = access().refusal(subject, [Capability.VIEW])
    assert "anna may do nothing, and this needs view" in sentence
    assert f"(X-Forwarded-Groups): {told.strip(',') or 'none'}" in sentence
    assert "with proxy.view" in sentence


@given(names)
def test_text_of_any_script_comes_as_it_was_sent(name: str) -> None:
    sent = name.encode().decode("latin-1")  # as a server hands on the bytes of a header
    subject = access(ProxySettings(view=(name,))).subject([], forwarded=Forwarded(sent, sent))
    assert (subject.name, subject.groups) == (name, (name,))
    assert subject.capabilities == ROLES[Capability.VIEW]


def test_whoever_comes_through_is_a_group_of_its_own() -> None:
    open_station = access(ProxySettings(demonstrate=("*",), operate=("cell-3-operators",)))
    for said, name in (("anna", "anna"), ("", ""), ("a\nb", "ab"), ("x" * 99, "x" * 64)):
        subject = open_station.subject([], forwarded=Forwarded(said))
        assert (subject.name, subject.capabilities) == (name, ROLES[Capability.DEMONSTRATE])
    assert open_station.notes() == []
    assert "sign in there" in open_station.refusal(open_station.subject([]), [Capability.OPERATE])


def test_a_group_with_characters_that_nobody_sees_is_none() -> None:
    subject = access().subject([], forwarded=Forwarded("anna", "cell-3\x00-operators,\x1b[2Jlab,lab"))
    assert (subject.groups, subject.capabilities) == (("lab",), ROLES[Capability.VIEW])


def test_groups_without_a_name_are_nobody_s() -> None:
    with pytest.raises(NotSignedIn, match="no name; let it set X-Forwarded-User"):
        access().subject([], forwarded=Forwarded("\n", "cell-3-operators"))


def test_what_a_proxy_says_counts_in_that_mode_alone() -> None:
    nobody_asks = Access(AuthSettings("none"), MemoryTokens(), MemoryPeople(), proxy=SETTINGS)
    assert nobody_asks.subject([], forwarded=Forwarded("anna", "lab")) == UNAUTHENTICATED_SUBJECT
    tokens = Access(AuthSettings("token"), MemoryTokens(), MemoryPeople(), proxy=SETTINGS)
    with pytest.raises(NotSignedIn):
        tokens.subject([], forwarded=Forwarded("anna", "lab"))


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        (ProxySettings(), 'no group has a role.*proxy.administer = \\["\\*"\\]'),
        (ProxySettings(view=("a,b",)), "proxy.view holds 'a,b'"),
        (ProxySettings(operate=("",)), "proxy.operate holds ''"),
        (ProxySettings(operate=(" a",)), "proxy.operate holds ' a'"),
        (ProxySettings("X-Groups: a", view=("*",)), "proxy.groups_header is 'X-Groups: a'"),
        (ProxySettings("", view=("*",)), "proxy.groups_header is ''"),
    ],
)
def test_a_station_whose_proxy_could_give_no_role_does_not_start(settings: ProxySettings, sentence: str) -> None:
    with pytest.raises(UnusableSettings, match=sentence):
        require_roles("proxy", settings)
    require_roles("token", settings)
    require_roles("proxy", SETTINGS)
