"""A stop is believed by the executor's status alone, and repeated until it shows."""

import queue
import threading
from collections.abc import Callable, Iterator

import pytest

from teachpath.errors import NotStopped
from teachpath.io import wire
from teachpath.io.memory_bus import MemoryBus
from teachpath.records import Command, ExecutorStatus
from teachpath.robot.stopper import Stopper
from teachpath_proto.control import CommandVerb, ExecutorState
from teachpath_proto.keys import Keys
from tests.waiting import HANG, wait_until

KEYS = Keys()
MOVING_STATUS = ExecutorStatus("run-1", ExecutorState.FOLLOWING)
ENDING = ExecutorStatus("run-1", ExecutorState.STOPPING, ending=True)


def never() -> bool:
    return False


class Desk:
    """A stopper and all that it puts; `answer` says with which status the executor answers a put."""

    def __init__(self) -> None:
        self.bus = MemoryBus()
        self.stopper = Stopper(self.bus, KEYS)
        self.puts: list[Command] = []
        self.answer: Callable[[], ExecutorStatus | None] = lambda: None
        self.bus.subscribe(KEYS.executor_stop, self._receive)

    def _receive(self, _: str, payload: bytes) -> None:
        self.puts.append(wire.decode_command(payload))
        if (status := self.answer()) is not None:
            self.stopper.on_status(status)

    def stop(self, execution: str = "run-1", is_starting: Callable[[], bool] = never) -> ExecutorStatus:
        return self.stopper.stop(Command(CommandVerb.STOP, execution, who="Ada"), is_starting)


@pytest.fixture
def desk() -> Iterator[Desk]:
    desk = Desk()
    yield desk
    desk.stopper.close()


@pytest.mark.parametrize(
    "status",
    [
        ENDING,
        ExecutorStatus("run-1", ExecutorState.ENDED),
        ExecutorStatus("run-1", ExecutorState.FAULTED),
        ExecutorStatus("", ExecutorState.IDLE),
        ExecutorStatus("run-2", ExecutorState.FOLLOWING),  # run-1 is over
    ],
)
def test_a_status_that_shows_it_confirms_a_stop(desk: Desk, status: ExecutorStatus) -> None:
    desk.answer = lambda: status
    assert desk.stop() == status


@pytest.mark.parametrize("status", [MOVING_STATUS, ExecutorStatus("run-1", ExecutorState.STOPPING)])
def test_an_arm_that_only_comes_to_hold_is_not_stopped_and_the_stop_is_repeated(
    desk: Desk, status: ExecutorStatus
) -> None:
    desk.answer = lambda: ENDING if len(desk.puts) > 5 else status
    assert desk.stop() == ENDING
    assert len(desk.puts) > 5
    assert len({put.id for put in desk.puts}) == 1
    assert {(put.execution, put.who) for put in desk.puts} == {("run-1", "Ada")}


def test_an_answer_from_whoever_gives_it_is_not_believed(desk: Desk) -> None:
    ended = wire.encode_status(ExecutorStatus("run-1", ExecutorState.ENDED))
    desk.bus.serve(KEYS.executor_stop, lambda _: ended)
    desk.answer = lambda: MOVING_STATUS
    with pytest.raises(NotStopped, match=r"NOT STOPPED: .* press the emergency stop of the arm"):
        desk.stop()


def test_a_status_from_before_the_stop_is_not_believed(desk: Desk) -> None:
    desk.stopper.on_status(ExecutorStatus("run-1", ExecutorState.ENDED))
    with pytest.raises(NotStopped):
        desk.stop()


def test_what_moves_is_stopped_whatever_it_is(desk: Desk) -> None:
    running = ExecutorStatus("run-2", ExecutorState.FOLLOWING)
    desk.answer = lambda: ENDING if len(desk.puts) > 3 else running
    assert desk.stop("") == ENDING


def test_an_execution_that_is_about_to_begin_is_not_taken_for_one_that_is_over(desk: Desk) -> None:
    desk.answer = lambda: ExecutorStatus("", ExecutorState.IDLE)
    desk.stop(is_starting=lambda: len(desk.puts) < 4)
    assert len(desk.puts) >= 4


def test_it_goes_on_after_whoever_asked_was_told_until_the_status_shows_it(desk: Desk) -> None:
    with pytest.raises(NotStopped):
        desk.stop()
    before = len(desk.puts)
    wait_until(lambda: len(desk.puts) > before, "it is repeated")
    desk.stopper.on_status(ENDING)
    wait_until(lambda: not desk.stopper.is_repeating, "it is repeated no more")


def test_many_who_stop_the_same_share_the_repeats(desk: Desk) -> None:
    outcomes: queue.Queue[ExecutorStatus] = queue.Queue()
    everybody_asked = threading.Event()
    desk.answer = lambda: ENDING if everybody_asked.is_set() else MOVING_STATUS
    threads = [threading.Thread(target=lambda: outcomes.put(desk.stop())) for _ in range(20)]
    for thread in threads:
        thread.start()
    wait_until(lambda: len({put.id for put in desk.puts}) == 20, "everybody's stop was put")
    everybody_asked.set()
    assert [outcomes.get(timeout=HANG) for _ in threads] == [ENDING] * 20
