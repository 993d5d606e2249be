"""What one subject may ask for at a time, on a clock of its own."""

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath.access.access import REFUSED_SUBJECT, UNAUTHENTICATED_SUBJECT
from teachpath.access.settings import LimitSettings
from teachpath.access.subject_limits import MAX_KNOWN, Kind, SubjectLimits, subject_name
from teachpath.errors import TooManyRequests
from teachpath.records import Subject

RATE, BURST = 4.0, 8
SETTINGS = LimitSettings(request_rate=RATE, request_burst=BURST, max_requests=3, max_uploads=2, max_websockets=1)


class Clock:
    now = 100.0

    def __call__(self) -> float:
        return self.now


def asked(limits: SubjectLimits, subject: str) -> bool:
    """Ask for something that ends at once; tell whether it was allowed."""
    try:
        limits.begin(subject, Kind.REQUEST)
    except TooManyRequests:
        return False
    limits.end(subject, Kind.REQUEST)
    return True


@given(pauses=st.lists(st.sampled_from([0.0, 0.0, 0.0, 0.125, 0.25, 0.5, 4.0]), max_size=80))
def test_in_no_time_does_a_subject_get_more_than_the_burst_and_the_rate(pauses: list[float]) -> None:
    clock = Clock()
    limits, allowed = SubjectLimits(SETTINGS, clock), list[float]()
    for pause in pauses:
        clock.now += pause
        if asked(limits, "anna"):
            allowed.append(clock.now)
    for first, begin in enumerate(allowed):
        for last, end in enumerate(allowed[first:], first):
            assert last - first + 1 <= BURST + (end - begin) * RATE


@given(pauses=st.lists(st.sampled_from([0.0, 0.25, 0.5, 1.0]), min_size=1, max_size=60))
def test_whoever_waits_as_long_as_is_said_goes_on(pauses: list[float]) -> None:
    clock = Clock()
    limits = SubjectLimits(SETTINGS, clock)
    for pause in pauses:
        clock.now += pause
        try:
            limits.begin("anna", Kind.REQUEST)
        except TooManyRequests as error:
            clock.now += error.wait
            limits.begin("anna", Kind.REQUEST)
        limits.end("anna", Kind.REQUEST)


def test_whoever_keeps_to_the_rate_is_never_refused() -> None:
    clock = Clock()
    limits = SubjectLimits(SETTINGS, clock)
    for _ in range(50 * BURST):
        clock.now += 1 / RATE
        assert asked(limits, "anna")


def test_refused_requests_cost_nothing() -> None:
    clock = Clock()
    limits = SubjectLimits(SETTINGS, clock)
    for _ in range(100 * BURST):
        asked(limits, "anna")
    clock.now += 1 / RATE
    assert asked(limits, "anna")


def test_no_subject_takes_from_another() -> None:
    limits = SubjectLimits(SETTINGS, Clock())
    while asked(limits, "anna"):
        pass
    assert [asked(limits, "otto") for _ in range(BURST)] == [True] * BURST
    assert not asked(limits, "otto")


@pytest.mark.parametrize(
    ("kind", "most", "setting"),
    [(Kind.REQUEST, 3, "max_requests"), (Kind.UPLOAD, 2, "max_uploads"), (Kind.WEBSOCKET, 1, "max_websockets")],
)
def test_so_many_are_open_and_no_more_until_one_has_ended(kind: Kind, most: int, setting: str) -> None:
    clock = Clock()
    limits = SubjectLimits(SETTINGS, clock)
    for _ in range(3):
        clock.now += BURST / RATE  # the rate is not what refuses here
        for _ in range(most):
            limits.begin("anna", kind)
        with pytest.raises(
            TooManyRequests, match=rf"{most} {kind} of anna .* \(limits\.{setting}\); .* raise the setting"
        ):
            limits.begin("anna", kind)
        limits.begin("otto", kind)
        limits.end("otto", kind)
        limits.end("anna", kind)
        limits.begin("anna", kind)
        for _ in range(most):
            limits.end("anna", kind)


def test_what_is_remembered_is_limited() -> None:
    limits = SubjectLimits(SETTINGS, Clock())
    for number in range(MAX_KNOWN + 10):
        with suppress(TooManyRequests):
            limits.begin(f"address {number}", Kind.REQUEST)
            limits.end(f"address {number}", Kind.REQUEST)
    assert len(limits._due) == MAX_KNOWN
    assert not limits._held


@pytest.mark.parametrize(
    ("address", "name"),
    [
        ("192.168.7.9", "address 192.168.7.9"),
        ("2001:db8:1:2:3:4:5:6", "address 2001:db8:1:2::"),
        ("2001:db8:1:2::1", "address 2001:db8:1:2::"),
        ("2001:db8:1:3::1", "address 2001:db8:1:3::"),
        ("::ffff:192.168.7.9", "address 192.168.7.9"),
        ("", "address unknown"),
        ("testclient", "address testclient"),
    ],
)
def test_a_stranger_counts_by_its_address_and_one_network_of_ipv6_as_one(address: str, name: str) -> None:
    assert subject_name(REFUSED_SUBJECT, address) == name
    assert subject_name(UNAUTHENTICATED_SUBJECT, address) == name


def test_whoever_is_known_counts_by_name_wherever_it_comes_from() -> None:
    cell = Subject("cell-3", frozenset(), "digest")
    assert subject_name(cell, "192.168.7.9") == subject_name(cell, "192.168.7.10") == "cell-3"
