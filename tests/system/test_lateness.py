"""The executor is stopped in mid-motion: the arm rests on its path, within its limits, and goes on from there."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from teachpath.io.store.motions import Motion, read_motion
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.program import PlanProgram
from teachpath.motion.settings import MotionSettings
from teachpath_client.errors import JobFailed
from teachpath_client.models import Execution, Plan
from teachpath_client.ros2.executed import executed_trajectory
from teachpath_client.ros2.messages import DIAGNOSTICS, MARKERS, TRAJECTORY, decode, encode, header
from teachpath_proto.control import ExecutorState
from tests.system.processes import Service, family
from tests.system.test_station import record
from tests.unit.clients.ros2.peer import RmwPeer
from tests.unit.clients.ros2.test_readings import NAMES
from tests.waiting import HANG, wait_until

ARM = Arm.of_variant()

pytestmark = pytest.mark.system

TASK = "late"
OFF_PATH = 3e-4  # m


@pytest.fixture(scope="module")
def plan(service: Service) -> Plan:
    return ready_plan(service, TASK)


def ready_plan(service: Service, task: str) -> Plan:
    """Show the paper's first experiment, learn it, and certify a path of it."""
    record(service, task, 12)
    run = service.station.learn(task)
    for path in run.learned.paths:
        with suppress(JobFailed):  # not every way leads past the obstacles
            return service.station.plan(path.id)
    raise AssertionError("no path can be followed")


def executor(service: Service) -> int:
    """The process that streams the setpoints."""
    (pid,) = (pid for pid, command in family(service.family) if "[executor]" in command)
    return pid


def motion_of(service: Service, execution: str) -> Motion:
    file = Path(service.data) / f"{execution}.mcap"
    answer = httpx.get(f"{service.url}/api/v1/executions/{execution}/recording", timeout=HANG, trust_env=False)
    file.write_bytes(answer.raise_for_status().content)
    return read_motion(file)


def path_of(motion: Motion) -> np.ndarray:
    """Return the tool's way (n, 3) that an execution was to take from where its first setpoint found the arm [m]."""
    assert motion.header is not None
    assert motion.header.plan is not None
    program = PlanProgram(motion.header.plan, np.array(motion.setpoints[0].position), MotionSettings(), ARM)
    positions = [program.current_q]
    while not program.finished:
        positions.append(program.step().position)
    return np.asarray(tool_pose(np.array(positions), ARM)[:, :3, 3])


def off_path(motion: Motion) -> float:
    """Return how far the tool was off its way at most [m]."""
    path, worst = path_of(motion), 0.0
    chords = np.diff(path, axis=0)
    for tool in tool_pose(np.array([s.position for s in motion.states]), ARM)[:, :3, 3]:
        ahead = tool - path[:-1]
        share = np.einsum("ij,ij->i", ahead, chords) / np.maximum(np.sum(chords**2, axis=1), 1e-18)
        distance = np.linalg.norm(ahead - np.clip(share, 0.0, 1.0)[:, None] * chords, axis=1)
        worst = max(worst, float(distance.min()))
    return worst


@pytest.mark.parametrize("seed", range(3))
def test_an_executor_that_oversleeps_leaves_the_arm_on_its_path(service: Service, plan: Plan, seed: int) -> None:
    rng = np.random.default_rng(seed)
    station = service.station
    station.wait_for_arm(timeout=HANG)
    execution = station.begin_execution(plan.id)
    pid = executor(service)
    for pause in rng.uniform(0.02, 0.5, 4):
        time.sleep(rng.uniform(0.2, 0.9))
        os.kill(pid, signal.SIGSTOP)
        time.sleep(pause)
        os.kill(pid, signal.SIGCONT)
    ended = station.wait(execution, timeout=HANG)
    assert (ended.status.state, ended.status.reason) == ("ended", "")
    motion = motion_of(service, execution.id)
    assert off_path(motion) <= OFF_PATH
    assert max(np.max(np.abs(s.velocity) / ARM.limits.speed) for s in motion.states) <= 1.0
    assert max(np.max(np.abs(s.torque) / ARM.limits.torque) for s in motion.states) <= 1.0


def test_an_executor_that_dies_leaves_the_arm_at_rest_on_its_path(service: Service, plan: Plan) -> None:
    station = service.station
    station.wait_for_arm(timeout=HANG)
    execution = station.begin_execution(plan.id, override=0.5)
    wait_until(lambda: station.get_execution(execution.id).status.progress > 0.1, "it is on its way")
    os.kill(executor(service), signal.SIGKILL)
    wait_until(lambda: motion_of(service, execution.id).states[-1].stopped, "the arm follows its way to rest")
    wait_until(lambda: np.abs(motion_of(service, execution.id).states[-1].velocity).max() < 0.01, "the arm stands")
    assert off_path(motion_of(service, execution.id)) <= OFF_PATH


def test_ros_2_sees_plan_arm_task_and_execution(service: Service, plan: Plan) -> None:
    with RmwPeer() as peer, Bridge(service, peer, "--plan", plan.id, "--task", TASK) as bridge:
        listed = subprocess.run(
            [*ROS2, "--router", peer.router, "--topics"], capture_output=True, text=True, check=True
        )
        assert "/joint_states  sensor_msgs/msg/JointState\n" in listed.stdout
        topics = ("joint_states", "tf", "teachpath/joint_trajectory", "teachpath/markers")
        wait_until(lambda: all(map(bridge.heard, topics)), "all come")
        service.station.wait_for_arm(timeout=HANG)
        execution = service.station.begin_execution(plan.id)
        wait_until(lambda: service.station.get_execution(execution.id).status.progress > 0.0, "it is on its way")
        service.station.stop(execution.id)
        wait_until(lambda: bridge.heard("teachpath/executed_trajectory"), "it is told when it has ended")
    assert f"plan {plan.id}: published on /teachpath/joint_trajectory" in bridge.said
    assert bridge.heard("teachpath/joint_trajectory") == [service.station.program(plan.id, "cdr")]
    _, *lines = decode(MARKERS, bridge.heard("teachpath/markers")[0]).markers
    demonstrations = [each for each in service.station.demonstrations(TASK) if each.verdict != "reject"]
    run = service.station.newest_run(TASK)
    assert run is not None
    groups = [f"{TASK}/demonstrations"] * len(demonstrations) + [f"{TASK}/paths"] * len(run.learned.paths)
    assert [line.ns for line in lines] == groups
    recorded = executed_trajectory(service.station.recorded_execution(execution.id), NAMES)
    assert recorded is not None
    assert bridge.heard("teachpath/executed_trajectory") == [encode(TRAJECTORY, **recorded)]


def test_ros_2_starts_a_plan_by_its_own_trajectory_alone(service: Service, plan: Plan) -> None:
    station = service.station
    station.wait_for_arm(timeout=HANG)
    before = {each.id for each in station.executions()}

    def new() -> list[Execution]:
        return [each for each in station.executions() if each.id not in before]

    with RmwPeer() as peer, Bridge(service, peer, "--plan", plan.id, "--execute") as bridge:
        own = decode(TRAJECTORY, station.program(plan.id, "cdr", rate=50.0))
        other = decode(TRAJECTORY, station.program(plan.id, "cdr", rate=50.0))
        for point in other.points:
            point.positions = point.positions + 0.001
        wait_until(lambda: any("%follow_joint_trajectory/" in token for token in peer.tokens()), "it listens")
        bridge.ask(other)
        wait_until(lambda: "refused: it is no plan's motion" in bridge.reports(), "another motion is refused")
        bridge.ask(own, stamp_ns=1)
        wait_until(lambda: "s old, limit 2 s" in bridge.reports(), "a stale one is refused")
        assert not new()
        # On a busy machine a request may be stale before it is read; one that comes while the arm moves is refused.
        wait_until(lambda: new() or bridge.ask(own), "it begins", pause=lambda _: time.sleep(0.2))
        (first,) = new()
        assert (first.plan, station.get_lease().holder) == (plan.id, "ROS 2, domain 0")
        wait_until(lambda: station.get_execution(first.id).status.duration > 0.1, "it moves")
        own.points, points = [], own.points
        wait_until(lambda: all(map(is_resting, new())) or bridge.ask(own), "a trajectory without points stops it")
        own.points = points
        wait_until(lambda: station.get_lease().holder == "", "control is given back")
        wait_until(lambda: len(new()) > 1 or bridge.ask(own), "it begins again", pause=lambda _: time.sleep(0.2))
    wait_until(lambda: all(each.status.state == "held" or is_resting(each) for each in new()), "the arm is held")
    station.stop_arm()
    wait_until(lambda: all(map(is_resting, new())), "the arm rests")
    wait_until(lambda: station.get_lease().holder == "", "control is given back")
    assert len(new()) == 2


def is_resting(execution: Execution) -> bool:
    return ExecutorState(execution.status.state).is_resting


ROS2 = [sys.executable, "-m", "teachpath_client", "ros2"]


class Bridge:
    """A running `teachpath-client ros2`; use it as a context manager, at whose end it gets SIGTERM.

    Attributes:
        said: on its standard error, at its end.
    """

    def __init__(self, service: Service, peer: RmwPeer, *words: str) -> None:
        self._peer, self.said = peer, ""
        for topic, kind in (
            ("joint_trajectory", TRAJECTORY),
            ("executed_trajectory", TRAJECTORY),
            ("markers", MARKERS),
        ):
            peer.announce("MS", f"/teachpath/{topic}", kind, number=len(topic))
        where = ["--router", peer.router, "--endpoint", service.endpoint, "--url", service.url]
        self._process = subprocess.Popen([*ROS2, *where, *words], stderr=subprocess.PIPE, text=True)

    def __enter__(self) -> "Bridge":
        try:
            wait_until(lambda: self.heard("joint_states") or self._process.poll() is not None, "it begins")
        except BaseException:
            self._process.kill()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        try:
            self._process.send_signal(signal.SIGTERM)
            _, self.said = self._process.communicate(timeout=HANG)
        finally:
            self._process.kill()
            self._process.wait(HANG)
        assert (self._process.returncode, "Traceback" in self.said) == (0, False), self.said

    def heard(self, topic: str) -> list[bytes]:
        return [content for key, content, _ in list(self._peer.heard) if key.startswith(f"0/{topic}/")]

    def reports(self) -> str:
        return "\n".join(decode(DIAGNOSTICS, each).status[0].message for each in self.heard("teachpath/execution"))

    def ask(self, trajectory: Any, stamp_ns: int = 0) -> None:
        fields = {"joint_names": trajectory.joint_names, "points": trajectory.points}
        content = encode(TRAJECTORY, header=header(stamp_ns or time.time_ns(), ""), **fields)
        self._peer.put("/teachpath/follow_joint_trajectory", TRAJECTORY, content)
