"""The check of trackers: a sound one keeps every rule, and each flaw breaks the rule that is about it."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from teachpath.errors import UnusableSample
from teachpath.io.wire import decode_sample
from teachpath_client.reading import HandReading
from teachpath_client.tracker_check.rules import Observation, Received, verdicts
from teachpath_proto.tracker_pb2 import HandSample, StartRecording, StopRecording

NOW_NS = 1_800_000_000 * 10**9
PERIOD = 0.02  # [s]
COUNT, CLOSED_SAMPLES = 150, range(25, 125)

# of the rules, by what their sentences begin with
NAME, SAMPLES, NUMBERS, CONGESTION, CLOCK, GRASP, RATE, LIVELINESS, HANDSHAKE = (
    "publishes under", "sends only", "numbers", "waits", "stamps", "closes", "gives", "announces", "ends",
)  # fmt: skip

Flaw = Callable[[Observation], None]


def sound() -> Observation:
    """A hand that closes, is carried on and opens, as a tracker should send it."""
    readings = (
        HandReading(
            i * PERIOD,
            (0.5, -0.2 + 0.004 * i, 0.5),
            (1.0, 0.0, 0.0, 0.0),
            (0.9 if i in CLOSED_SAMPLES else 0.1,) * 22,
        )
        for i in range(COUNT)
    )
    payloads = [reading.message(7 + i, NOW_NS).SerializeToString() for i, reading in enumerate(readings)]
    received = [Received("mine", p, NOW_NS + round(1e9 * PERIOD * i)) for i, p in enumerate(payloads)]
    return Observation(
        received,
        {"mine"},
        StartRecording(task="stack", tracker="mine"),
        StopRecording(tracker="mine", last_sequence=6 + COUNT),
    )


def changed(change: Callable[[HandSample, int], None]) -> Flaw:
    """Let every sample be changed."""

    def flaw(seen: Observation) -> None:
        for place, one in enumerate(seen.received):
            sample = HandSample.FromString(one.payload)
            change(sample, place)
            seen.received[place] = replace(one, payload=sample.SerializeToString())

    return flaw


def lose_one(seen: Observation) -> None:
    del seen.received[60]


def swap_two(seen: Observation) -> None:
    seen.received[60:62] = reversed(seen.received[60:62])


def double_one(seen: Observation) -> None:
    seen.received.insert(60, seen.received[60])


def two_names(seen: Observation) -> None:
    seen.received[60] = replace(seen.received[60], tracker="other")


def say_nothing(seen: Observation) -> None:
    seen.received.clear()


def drop(seen: Observation) -> None:
    seen.received = [replace(one, blocks=False) for one in seen.received]


def rubbish(seen: Observation) -> None:
    seen.received[60] = replace(seen.received[60], payload=b"\xff\xff")


def flood(seen: Observation) -> None:
    seen.received[60] = replace(seen.received[60], payload=bytes(5000))


def hide(seen: Observation) -> None:
    seen.announced.clear()


def never_stop(seen: Observation) -> None:
    seen.stopped = None


def forget_the_last(seen: Observation) -> None:
    seen.stopped = StopRecording(tracker="mine")


def stop_another(seen: Observation) -> None:
    seen.stopped = StopRecording(tracker="other", last_sequence=6 + COUNT)


def in_millimetres(sample: HandSample, _: int) -> None:
    sample.position.x *= 1000


def turn_unfinished(sample: HandSample, _: int) -> None:
    sample.orientation.w = 0.5


def with_nan(sample: HandSample, place: int) -> None:
    if place == 60:
        sample.position.z = math.nan


def in_degrees(sample: HandSample, _: int) -> None:
    sample.flexions[:] = [90.0 * value for value in sample.flexions]


def in_microseconds(sample: HandSample, _: int) -> None:
    sample.device_ns //= 1000


def from_the_start(sample: HandSample, _: int) -> None:
    sample.device_ns -= NOW_NS - 1


def stand_still(sample: HandSample, place: int) -> None:
    sample.device_ns = NOW_NS + min(place, 60) * round(1e9 * PERIOD)


def never_close(sample: HandSample, _: int) -> None:
    sample.flexions[:] = [min(value, 0.5) for value in sample.flexions]


def carry_nothing(sample: HandSample, place: int) -> None:
    sample.position.y = -0.2 + 0.00001 * place


def repeat(sample: HandSample, place: int) -> None:
    sample.position.y = -0.2 + 0.04 * (place // 10)


FLAWS: list[tuple[Flaw, set[str]]] = [
    (lose_one, {NUMBERS}),
    (swap_two, {NUMBERS, CLOCK}),
    (double_one, {NUMBERS, CLOCK}),
    (two_names, {NAME}),
    (drop, {CONGESTION}),
    (rubbish, {SAMPLES, NUMBERS}),
    (flood, {SAMPLES, NUMBERS}),
    (hide, {LIVELINESS}),
    (never_stop, {HANDSHAKE}),
    (forget_the_last, {HANDSHAKE}),
    (stop_another, {HANDSHAKE}),
    (changed(turn_unfinished), {SAMPLES}),
    (changed(in_millimetres), {SAMPLES}),
    (changed(in_degrees), {SAMPLES}),
    (changed(with_nan), {SAMPLES, NUMBERS}),
    (changed(in_microseconds), {CLOCK}),
    (changed(from_the_start), {CLOCK}),
    (changed(stand_still), {CLOCK}),
    (changed(never_close), {GRASP}),
    (changed(carry_nothing), {GRASP}),
    (changed(repeat), {RATE}),
    (say_nothing, {NAME}),
]


def broken(seen: Observation) -> set[str]:
    """The rules that are broken; each says why, in a sentence that ends."""
    found = [verdict for verdict in verdicts(seen) if verdict.fault]
    return {verdict.rule for verdict in found}


def test_a_sound_tracker_keeps_every_rule() -> None:
    assert len(list(verdicts(sound()))) == 9
    assert broken(sound()) == set()


@pytest.mark.parametrize(("flaw", "rules"), FLAWS)
def test_a_flaw_breaks_the_rule_that_is_about_it(flaw: Flaw, rules: set[str]) -> None:
    seen = sound()
    flaw(seen)
    found = broken(seen)
    assert len(found) == len(rules)
    assert all(any(rule.startswith(start) for rule in found) for start in rules)


@pytest.mark.parametrize("stall", [0.1, 0.5, 1.2])
def test_samples_that_a_stall_delays_wherever_it_falls_say_nothing_of_the_clock(stall: float) -> None:
    for begin in range(0, COUNT, 20):
        seen = sound()
        over = seen.received[begin].receive_ns + round(1e9 * stall)
        for place in range(begin, COUNT):
            came = max(seen.received[place].receive_ns, over)
            seen.received[place] = replace(seen.received[place], receive_ns=came)
        assert broken(seen) == set(), begin


@pytest.mark.parametrize("rate", [0.85, 1.15])
def test_a_clock_that_runs_too_fast_or_too_slowly_is_noticed_beside_a_stall(rate: float) -> None:
    for begin in range(0, COUNT, 50):
        seen = sound()
        changed(lambda sample, place: setattr(sample, "device_ns", NOW_NS + round(1e9 * rate * PERIOD * place)))(seen)
        over = seen.received[begin].receive_ns + round(0.5e9)
        seen.received = [
            replace(one, receive_ns=max(one.receive_ns, over) if place >= begin else one.receive_ns)
            for place, one in enumerate(seen.received)
        ]
        assert {rule.split()[0] for rule in broken(seen)} == {CLOCK}, begin


def test_a_tracker_whose_recordings_others_begin_needs_no_handshake() -> None:
    seen = sound()
    seen.started = seen.stopped = None
    assert broken(seen) == set()


def test_the_check_refuses_what_the_recorder_refuses() -> None:
    """A sample with random faults is refused by both or by neither."""
    random = np.random.default_rng(5)
    values = [0.0, 1.0, -1.0, 0.5, 99.0, 101.0, math.nan, math.inf, 1e-3]
    for _ in range(500):
        sample = HandSample.FromString(sound().received[0].payload)
        for field in random.choice(["position.x", "orientation.w", "orientation.z", "device_ns", "flexions"], 2):
            value = float(random.choice(values))
            if field == "device_ns":
                sample.device_ns = int(random.choice([0, -5, NOW_NS]))
            elif field == "flexions":
                sample.flexions[:] = [value] * int(random.choice([0, 3, 18, 22]))
            else:
                owner, name = field.split(".")
                setattr(getattr(sample, owner), name, value)
        payload = sample.SerializeToString()
        seen = Observation([Received("mine", payload, NOW_NS)])
        refused = any(rule.startswith(SAMPLES) for rule in broken(seen))
        try:
            decode_sample("mine", payload, NOW_NS)
            assert not refused
        except UnusableSample:
            assert refused
