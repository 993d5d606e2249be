"""Everything that is executed is in one file, also when the service was killed or the disk was full."""

import io
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from teachpath.errors import NotFound
from teachpath.io import wire
from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.motions import MotionHeader, Motions, read_motion
from teachpath.motion.analysis.time_series import time_series
from teachpath.motion.arm.model import Arm
from teachpath.records import ExecutorStatus, JointState, JournalEntry, Plan, Setpoint
from teachpath.robot.motion_recorder import SETTLING_NS, STOPPING_NS, MotionRecorder
from teachpath_proto.control import ExecutorState, JournalVerb
from teachpath_proto.keys import Keys
from tests.unit.executor.executors import Bench
from tests.unit.motion.ways import MIDDLE, way

ARM = Arm.of_variant()

KEYS = Keys()
EPOCH = 1_700_000_000 * 10**9


class Desk:
    """A recorder on a clock of its own."""

    def __init__(self, folder: Path, opener: object = None) -> None:
        self.now = EPOCH
        self.bus = MemoryBus()
        self.motions = Motions(folder, opener) if opener else Motions(folder)  # type: ignore[arg-type]
        self.recorder = MotionRecorder(self.bus, KEYS, self.motions, robot="puma560", clock=lambda: self.now)
        self.recorder.start()

    def send(self, cycle: int, execution: str = "execution-1") -> None:
        q = np.full(6, 0.001 * cycle)
        setpoint = Setpoint(cycle, self.now, self.now + 1000, q, q, q, False, execution, True)
        self.bus.publish(KEYS.setpoint("puma560"), wire.encode_setpoint(setpoint))
        self.now += 4_000_000

    def move(self, speed: float, *, stopped: bool = True) -> None:
        """Let the arm say how fast it moves [rad/s], and whether it has come to the end of its way to rest."""
        zero = np.zeros(6)
        place = (0.0,) * 3, (0.0,) * 4
        state = JointState(self.now, 1, zero, zero + speed, zero, 0.0, 0, False, False, *place, stopped=stopped)
        self.bus.publish(KEYS.state("puma560"), wire.encode_state(state))
        self.recorder.process_round()

    def tell(self, state: str) -> None:
        status = ExecutorStatus(execution="execution-1", state=ExecutorState(state))
        self.bus.publish(KEYS.executor_status, wire.encode_status(status))


def test_a_motion_is_written_whole_and_read_back(tmp_path: Path, middle: Plan) -> None:
    desk = Desk(tmp_path)
    desk.recorder.begin(MotionHeader("execution-1", "puma560", middle, way(MIDDLE)))
    desk.tell("following")
    for cycle in (0, 1, 2, 5):
        desk.send(cycle)
    desk.send(7, "another")
    desk.bus.publish(
        KEYS.executor_journal, wire.encode_entry(JournalEntry(1, "Ada", JournalVerb.HOLD, "execution-1", "done"))
    )
    desk.tell("ended")
    desk.recorder.process_round()
    assert desk.motions.path("execution-1").suffix == ".part"
    desk.now += SETTLING_NS + 1
    desk.recorder.process_round()
    motion = read_motion(tmp_path / "execution-1.mcap")
    assert motion.fault == ""
    assert [s.cycle for s in motion.setpoints] == [0, 1, 2, 5]
    assert all(s.on_path for s in motion.setpoints)
    assert [status.state for _, status in motion.statuses] == ["following", "ended"]
    assert motion.journal[0].who == "Ada"
    assert motion.facts == {"execution": "execution-1", "setpoints": "4", "lost": "2"}
    assert motion.header is not None
    assert motion.header.plan is not None
    assert motion.header.plan.joints.tobytes() == middle.joints.tobytes()
    assert motion.header.path is not None
    desk.recorder.stop()
    with pytest.raises(NotFound, match="has no recording"):
        desk.motions.path("execution-2")


def test_who_asks_right_after_the_end_waits_for_the_whole_file(tmp_path: Path) -> None:
    desk = Desk(tmp_path)
    desk.recorder.begin(MotionHeader("execution-1", "puma560"))
    desk.send(0)
    desk.tell("ended")
    with ThreadPoolExecutor() as pool:
        asked = pool.submit(lambda: (desk.recorder.wait_for_file("execution-1"), desk.motions.path("execution-1"))[1])
        desk.recorder.wait_for_file("execution-0")  # of another one nothing is to come
        assert desk.motions.path("execution-1").suffix == ".part"
        desk.now += SETTLING_NS + 1
        assert asked.result().suffix == ".mcap"
    desk.recorder.stop()


def test_after_the_death_of_the_executor_the_file_goes_on_until_the_arm_rests(tmp_path: Path) -> None:
    desk = Desk(tmp_path)
    desk.recorder.begin(MotionHeader("execution-1", "puma560"))
    desk.send(0)
    desk.recorder.finish_at_rest()
    desk.now += STOPPING_NS // 2  # in which its process got no turn
    for speed, stopped in ((0.4, False), (0.3, True), (0.0, True)):
        desk.move(speed, stopped=stopped)
        desk.now += SETTLING_NS // 2
    assert desk.motions.path("execution-1").suffix == ".part"
    desk.now += SETTLING_NS // 2 + 1
    desk.recorder.process_round()
    assert read_motion(tmp_path / "execution-1.mcap").states[-1].stopped
    desk.recorder.begin(MotionHeader("execution-2", "puma560"))
    desk.recorder.finish_at_rest()  # of an arm that says nothing any more
    desk.now += STOPPING_NS + 1
    desk.recorder.process_round()
    assert desk.motions.path("execution-2").suffix == ".mcap"
    desk.recorder.stop()


def test_a_file_that_a_kill_left_is_made_whole_at_the_next_start(tmp_path: Path) -> None:
    desk = Desk(tmp_path)
    desk.recorder.begin(MotionHeader("execution-1", "puma560"))
    for cycle in range(500):
        desk.send(cycle)
    desk.recorder.process_round()  # a second has passed: flushed
    part = desk.motions.path("execution-1")
    torn = part.read_bytes()[:-7]
    desk.recorder.stop()
    (tmp_path / "execution-1.mcap").unlink()
    part.write_bytes(torn)
    (tmp_path / "execution-2.mcap.part").write_bytes(b"\x89MC")
    again = Desk(tmp_path)
    motion = read_motion(again.motions.path("execution-1"))
    again.recorder.stop()
    assert motion.fault == ""
    assert "mended" in motion.facts
    assert len(motion.setpoints) > 400
    assert [s.cycle for s in motion.setpoints] == list(range(len(motion.setpoints)))
    assert (tmp_path / "execution-1.mcap.torn").read_bytes() == torn
    assert (tmp_path / "execution-2.mcap.part").exists()  # nothing to be had from it, and nothing thrown away


def test_a_full_disk_is_said_and_stops_no_arm(tmp_path: Path) -> None:
    class Full(io.BytesIO):
        def write(self, data: object) -> int:
            if self.tell() > 3000:
                raise OSError(28, "No space left on device")
            return super().write(data)  # type: ignore[arg-type]

    desk = Desk(tmp_path, lambda _: Full())
    desk.recorder.begin(MotionHeader("execution-1", "puma560"))
    for cycle in range(2000):
        desk.send(cycle)
    desk.recorder.process_round()
    assert "execution-1 is not recorded" in desk.recorder.fault
    assert "make room on the disk" in desk.recorder.fault
    desk.recorder.stop()


def test_a_series_has_no_more_points_than_asked_and_loses_no_peak(middle: Plan) -> None:
    bench = Bench()
    states = []
    bench.bus.subscribe(KEYS.state("puma560"), lambda _, payload: states.append(wire.decode_state(payload)))
    bench.oversleep = {300: 3_000_000}
    bench.start(middle)
    bench.when(lambda: len(bench.setpoints) == 400, lambda: setattr(bench, "error", 0.03))
    bench.when(lambda: len(bench.setpoints) == 402, lambda: setattr(bench, "error", 0.0))
    bench.when(lambda: bench.state == "ended", bench.stop.set)
    bench.run()
    drawn = time_series(bench.setpoints, states, 50, ARM)
    assert len(drawn.times) == 50
    assert drawn.positions.shape == drawn.velocities.shape == drawn.torques.shape == (50, 6)
    assert drawn.tracking_error.max() == pytest.approx(0.03)
    assert drawn.lateness.max() == pytest.approx(0.003)
    assert np.all(np.diff(drawn.times) > 0)
    assert drawn.times[-1] == pytest.approx(len(bench.setpoints) / 250, abs=0.2)
    np.testing.assert_allclose(drawn.positions[-1], bench.setpoints[-1].position)
    assert len(time_series([], [], 50, ARM).times) == 0
