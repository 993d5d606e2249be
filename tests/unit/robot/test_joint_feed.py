from dataclasses import replace

import numpy as np
import pytest

from teachpath.io.memory_bus import MemoryBus
from teachpath.io.wire import encode_setpoint, encode_state
from teachpath.records import JointState, Setpoint
from teachpath.robot.joint_feed import MAX_QUEUED, JointFeed
from teachpath_proto.keys import Keys

KEYS = Keys("test")
REST = np.zeros(6)
STATE = JointState(1, 1, REST, REST, REST, 0.0, 0, False, True, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0))


@pytest.fixture
def bus() -> MemoryBus:
    return MemoryBus()


@pytest.fixture
def feed(bus: MemoryBus) -> JointFeed:
    feed = JointFeed(bus, KEYS, robot="arm")
    feed.start()
    return feed


def publish(bus: MemoryBus, stamp: int, *, speed: float = 0.0, error: float = 0.0) -> None:
    velocity = np.array([speed, 0, 0, 0, 0, 0])
    state = replace(STATE, stamp_ns=stamp, velocity=velocity, tracking_error=error)
    bus.publish(KEYS.state("arm"), encode_state(state))


def setpoint(bus: MemoryBus, late_ns: int) -> None:
    bus.publish(KEYS.setpoint("arm"), encode_setpoint(Setpoint(1, 10**9, 10**9 + late_ns, REST, REST, REST, True, "e")))


def test_frames_hold_the_newest_state_and_the_worst_between(bus: MemoryBus, feed: JointFeed) -> None:
    onlooker = feed.subscribe()
    assert onlooker.poll() is None
    for stamp, (speed, error) in enumerate([(0.5, 0.001), (-2.0, 0.003), (1.0, 0.002)]):
        publish(bus, stamp, speed=speed, error=error)
    setpoint(bus, 40_000)
    setpoint(bus, 20_000)
    frame = onlooker.poll()
    assert frame is not None
    assert (frame.state.stamp_ns, frame.speed[0], frame.tracking_error) == (2, -2.0, 0.003)
    assert frame.lateness == pytest.approx(40e-6)
    assert onlooker.poll() is None
    publish(bus, 3)
    later = onlooker.poll()
    assert later is not None
    assert (later.tracking_error, later.lateness) == (0.0, None)


def test_every_onlooker_sees_all_and_begins_with_the_newest(bus: MemoryBus, feed: JointFeed) -> None:
    first = feed.subscribe()
    publish(bus, 1)
    second = feed.subscribe()
    frames = [first.poll(), second.poll()]
    assert [frame.state.stamp_ns for frame in frames if frame] == [1, 1]
    feed.unsubscribe(first)
    publish(bus, 2)
    assert first.poll() is None
    assert second.poll() is not None


def test_one_that_never_looks_fills_no_memory_and_rubbish_is_left_out(bus: MemoryBus, feed: JointFeed) -> None:
    onlooker = feed.subscribe()
    for stamp in range(MAX_QUEUED + 10):
        publish(bus, stamp)
        bus.publish(KEYS.setpoint("arm"), b"rubbish")
    bus.publish(KEYS.state("arm"), b"rubbish")
    assert len(onlooker.states) == len(onlooker.setpoints) == MAX_QUEUED
    frame = onlooker.poll()
    assert frame is not None
    assert frame.state.stamp_ns == MAX_QUEUED + 9
    assert frame.lateness is None
    feed.stop()
    feed.stop()
    publish(bus, 1)
    assert onlooker.poll() is None
