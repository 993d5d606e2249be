"""Places that are touched with a tracker: their mean, and what is refused."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor

import pytest

from teachpath.errors import Conflict, NotFound, Unanswered
from teachpath.io.wire import encode_sample
from teachpath.recorder.presence import Presence
from teachpath.recorder.touches import MAX_DEVIATION, MAX_TOUCHES, MIN_READINGS, Touch, Touches
from teachpath.records import Sample, Vector
from teachpath_proto.keys import Keys
from tests.waiting import wait_until

KEYS = Keys("test")
PERIOD_NS = 20_000_000
RATE = 50  # [Hz]


class Bench:
    """Touched places of trackers that are there, on a clock that stands."""

    def __init__(self, *trackers: str, timeout: float = 300.0) -> None:
        presence = Presence(lambda: 0.0)
        for tracker in trackers:
            presence.on_liveliness(tracker, True)
        self.touches = Touches(KEYS, presence, timeout=timeout)
        self._pool = ThreadPoolExecutor()

    def touch(self, tracker: str = "glove", *, hold_time: float = 1.0) -> Future[Touch]:
        """Begin to touch a place, and return as soon as readings count."""
        touch = self._pool.submit(self.touches.measure, tracker, hold_time=hold_time)
        wait_until(lambda: self.touches.is_waiting_for(tracker), "the place is being touched")
        return touch

    def send(self, positions: Sequence[Vector], *, tracker: str = "glove", tracked: bool = True) -> None:
        for k, position in enumerate(positions):
            sample = Sample(tracker, k, (k + 1) * PERIOD_NS, 0, position, None, (), tracked)
            self.touches.on_sample(KEYS.samples(tracker), encode_sample(sample))


def swaying(count: int, by: float) -> list[Vector]:
    """Return readings that lie `by` [m] on either side of a place, in turn."""
    return [(0.1 + (by if k % 2 else -by), 0.2, 0.3) for k in range(count)]


def test_a_touched_place_is_the_mean_over_the_time_that_it_was_held() -> None:
    bench = Bench("glove", "other")
    touch = bench.touch(hold_time=1.0)
    bench.send(swaying(RATE, 1.0), tracker="other")  # which touches nothing
    bench.touches.on_sample(KEYS.samples("glove"), b"no sample")
    bench.send(swaying(RATE + 1, 0.001))
    found = touch.result()
    assert (found.tracker, found.readings) == ("glove", RATE + 1)
    assert found.position == pytest.approx((0.1, 0.2, 0.3), abs=1e-4)
    assert 0.0009 < found.deviation < 0.0011
    assert not bench.touches.is_waiting_for("glove")


@pytest.mark.parametrize(
    ("send", "sentence"),
    [
        (lambda bench: bench.send(swaying(RATE + 1, 2 * MAX_DEVIATION)), "glove moved by 10 mm .* 5 mm are allowed"),
        (lambda bench: bench.send(swaying(RATE + 1, 0.0), tracked=False), "not tracked in 51 of 51 readings"),
    ],
)
def test_a_tracker_that_moved_or_was_not_seen_is_asked_again(send: Callable[[Bench], None], sentence: str) -> None:
    bench = Bench("glove")
    touch = bench.touch()
    send(bench)
    with pytest.raises(Conflict, match=sentence):
        touch.result()


def test_who_sends_too_little_is_told_so_and_who_is_not_there_at_once() -> None:
    silent = Bench("glove", timeout=0.0)
    with pytest.raises(Unanswered, match=rf"0 readings over 0 s of glove .* {MIN_READINGS} over 1 s are needed"):
        silent.touches.measure("glove", hold_time=1.0)
    with pytest.raises(NotFound, match="there is no tracker 'fastrak' now; there are: glove"):
        silent.touches.measure("fastrak", hold_time=1.0)


def test_one_place_at_a_time_is_touched_with_a_tracker_and_few_in_all() -> None:
    names = [f"glove-{k}" for k in range(MAX_TOUCHES + 1)]
    bench = Bench(*names)
    touches = [bench.touch(name) for name in names[:-1]]
    with pytest.raises(Conflict, match="with glove-0 already"):
        bench.touches.measure("glove-0", hold_time=1.0)
    with pytest.raises(Conflict, match=f"{MAX_TOUCHES} places are being touched already"):
        bench.touches.measure(names[-1], hold_time=1.0)
    for name, touch in zip(names, touches, strict=False):
        bench.send(swaying(RATE + 1, 0.0), tracker=name)
        assert touch.result().tracker == name
