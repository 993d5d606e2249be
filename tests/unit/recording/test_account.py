from hypothesis import given
from hypothesis import strategies as st

from teachpath.recording import StreamAccount
from tests.unit.recording.hands import sample


def account_of(sequences: list[int], expected: int | None = None) -> StreamAccount:
    account = StreamAccount()
    for sequence in sequences:
        account.observe(sample(sequence, (0.0, 0.0, 0.0)))
    if expected is not None:
        account.expect(expected)
    return account


@given(
    sent=st.integers(2, 60),
    kept=st.sets(st.integers(2, 60)),
    twice=st.lists(st.integers(1, 60), max_size=10),
    order=st.randoms(use_true_random=False),
)
def test_every_sample_sent_is_received_or_lost(sent: int, kept: set[int], twice: list[int], order) -> None:  # type: ignore[no-untyped-def]
    arrived = [n for n in range(2, sent + 1) if n in kept]
    stream = arrived + [n for n in twice if n in arrived]
    order.shuffle(stream)
    account = account_of([1, *stream], sent).account()
    assert account.lost == sent - 1 - len(arrived)
    assert account.duplicated == len(stream) - len(arrived)
    assert account.received == 1 + len(stream)


def test_order_decides_between_late_and_in_time() -> None:
    account = account_of([1, 2, 5, 3, 4, 4, 6]).account()
    assert (account.reordered, account.duplicated, account.lost) == (2, 1, 0)


def test_a_restarted_device_is_noted_not_counted_as_a_million_lost() -> None:
    account = account_of([1, 2, 5_000_000]).account()
    assert account.lost == 0
    assert any("restarted" in note for note in account.notes)


def test_nothing_came_is_said() -> None:
    account = account_of([], 40).account()
    assert any("no sample came" in note for note in account.notes)


def test_the_longest_gap_is_that_of_the_devices_clock() -> None:
    assert account_of([1, 2, 6, 7]).account().longest_gap_ns == 4 * 20_000_000
