"""The executor is stopped in mid-motion: the arm rests on its path, within its limits, and goes on from there."""

import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import httpx
import numpy as np
import pytest

from teachpath.io.store.motions import Motion, read_motion
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.motion.execution.program import PlanProgram
from teachpath.motion.settings import MotionSettings
from teachpath_client.errors import JobFailed
from teachpath_client.models import Plan
from tests.system.processes import Service, family
from tests.system.test_station import record
from tests.unit.clients.ros2.peer import RmwPeer
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


def test_the_plan_and_what_the_arm_does_reach_ros_2(service: Service, plan: Plan) -> None:
    words = ["--endpoint", service.endpoint, "--url", service.url, "--plan", plan.id]
    with RmwPeer() as peer:
        peer.announce("MS", "/teachpath/joint_trajectory", "trajectory_msgs/msg/JointTrajectory")
        command = [sys.executable, "-m", "teachpath_client", "ros2", "--router", peer.router]
        listed = subprocess.run([*command, "--topics"], capture_output=True, text=True, timeout=HANG, check=True)
        assert listed.stdout == ""  # nobody publishes yet
        bridge = subprocess.Popen([*command, *words], stderr=subprocess.PIPE, text=True)

        def heard(topic: str) -> list[bytes]:
            return [content for key, content, _ in list(peer.heard) if key.startswith(f"0/{topic}/")]

        try:
            topics = ("joint_states", "tf", "teachpath/joint_trajectory")
            wait_until(lambda: all(heard(topic) for topic in topics) or bridge.poll() is not None, "all come")
            bridge.send_signal(signal.SIGTERM)
            _, said = bridge.communicate(timeout=HANG)
        finally:
            bridge.kill()
            bridge.wait(HANG)
    assert (bridge.returncode, "Traceback" in said) == (0, False), said
    assert f"plan {plan.id}: published on /teachpath/joint_trajectory" in said
    assert heard("teachpath/joint_trajectory") == [service.station.program(plan.id, "cdr")]
