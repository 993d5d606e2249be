import pytest

from teachpath.errors import UnusableInput
from teachpath.recording.state_machine import RecordingStateMachine
from teachpath.records import RecordingState, Routine


def test_records_at_once_or_waits_armed() -> None:
    assert RecordingStateMachine(Routine(), 0.0).state is RecordingState.RECORDING
    armed = RecordingStateMachine(Routine(armed=True), 0.0)
    assert armed.state is RecordingState.PAUSED
    armed.resume(1.0)
    assert armed.state is RecordingState.RECORDING


def test_counts_down_before_every_take() -> None:
    machine = RecordingStateMachine(Routine(countdown=3.0), 10.0)
    assert (machine.state, machine.countdown_left(11.0)) == (RecordingState.COUNTDOWN, pytest.approx(2.0))
    assert not machine.poll_countdown(12.9)
    assert machine.poll_countdown(13.0)
    assert (machine.state, machine.countdown_left(13.0)) == (RecordingState.RECORDING, 0.0)
    machine.end_take(20.0, made=True)
    assert (machine.state, machine.countdown_left(20.0)) == (RecordingState.COUNTDOWN, pytest.approx(3.0))


def test_what_the_routine_does_not_say_the_settings_do() -> None:
    assert RecordingStateMachine(Routine(), 0.0, countdown=2.0).countdown_left(0.0) == 2.0
    assert RecordingStateMachine(Routine(countdown=0.0), 0.0, countdown=2.0).state is RecordingState.RECORDING


def test_pauses_by_itself_after_so_many_takes_and_begins_another_series() -> None:
    machine = RecordingStateMachine(Routine(takes=2), 0.0)
    machine.end_take(1.0, made=True)
    machine.end_take(2.0, made=False)  # let go at once: no take
    assert (machine.state, machine.takes_left) == (RecordingState.RECORDING, 1)
    machine.end_take(3.0, made=True)
    assert (machine.state, machine.takes_left) == (RecordingState.PAUSED, 0)
    machine.resume(4.0)
    assert (machine.state, machine.takes_left) == (RecordingState.RECORDING, 2)


def test_one_by_one_waits_after_each_take() -> None:
    machine = RecordingStateMachine(Routine(one_by_one=True), 0.0)
    machine.end_take(1.0, made=True)
    assert machine.state is RecordingState.PAUSED


@pytest.mark.parametrize("made", [True, False])
def test_a_pause_waits_for_what_is_carried_and_no_longer(made: bool) -> None:
    machine = RecordingStateMachine(Routine(), 0.0)
    machine.pause(carrying=True)
    machine.pause(carrying=True)
    assert machine.state is RecordingState.PAUSING
    machine.end_take(1.0, made=made)
    assert machine.state is RecordingState.PAUSED


def test_a_pause_during_the_countdown_is_a_pause() -> None:
    machine = RecordingStateMachine(Routine(countdown=3.0), 0.0)
    machine.pause(carrying=False)
    assert machine.state is RecordingState.PAUSED
    assert not machine.poll_countdown(99.0)


def test_a_tracker_that_comes_back_goes_on_as_it_was() -> None:
    for before, after in (
        (RecordingState.RECORDING, RecordingState.RECORDING),
        (RecordingState.PAUSED, RecordingState.PAUSED),
    ):
        machine = RecordingStateMachine(Routine(armed=before is RecordingState.PAUSED), 0.0)
        machine.on_tracker_lost()
        machine.on_sample()
        assert machine.state is after
    lost = RecordingStateMachine(Routine(), 0.0)
    lost.on_tracker_lost()
    lost.resume(0.0)
    assert lost.state is RecordingState.LOST


@pytest.mark.parametrize("countdown", [-1.0, 61.0, float("nan"), float("inf")])
def test_a_countdown_without_an_end_is_refused(countdown: float) -> None:
    with pytest.raises(UnusableInput, match="a countdown of"):
        Routine(countdown=countdown)
