"""The paper's hand through the bytes of a FASTRAK and a CyberGlove, as an operator would record it."""

import itertools
import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest

from teachpath_client import HandReading, Link
from teachpath_client.devices.emulators import Emulator
from teachpath_client.devices.glove_calibration import GloveCalibration
from teachpath_client.devices.protocol_simulators import FastrakSimulator, GloveSimulator
from teachpath_client.synthetic import GOAL, RATE, START, experiment_1
from teachpath_proto import tracker_pb2
from teachpath_proto.keys import Keys
from tests.system.processes import Service
from tests.unit.clients.ros2 import golden
from tests.unit.clients.ros2.peer import RmwPeer
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

SAMPLE_COUNT = 353  # samples that the synthetic hand needs for one demonstration
GLOVE = GloveCalibration((60.0,) * 22, (1 / 120,) * 22)
TRACKER = "paper-hand"


@pytest.fixture
def devices(tmp_path: Path) -> Iterator[tuple[Emulator, Emulator]]:
    """A tracker that shows its first reading until it is told to go on, and a glove on the hand that it follows."""
    GLOVE.save(tmp_path / "glove.toml")
    with ExitStack() as stack:
        tracker = stack.enter_context(Emulator(FastrakSimulator(), tmp_path / "fastrak", rate=RATE, hold=True))
        glove = stack.enter_context(
            Emulator(GloveSimulator(GLOVE), tmp_path / "glove", rate=RATE, hand=lambda: tracker.now)
        )
        yield tracker, glove


def recording(service: Service) -> tracker_pb2.RecordingReport | None:
    """Return the report of the running recording of the tracker, if there is one."""
    with Link(service.endpoint) as link:
        status = tracker_pb2.RecorderStatus.FromString(link.ask(Keys().recorder_status))
    return next((report for report in status.recordings if report.tracker == TRACKER), None)


def test_the_first_demonstration_of_the_paper_through_fastrak_and_cyberglove(
    service: Service, devices: tuple[Emulator, Emulator], tmp_path: Path
) -> None:
    shown: list[HandReading] = list(itertools.islice(experiment_1(), SAMPLE_COUNT))
    tracker, glove = devices
    tracker.show(shown[0])
    options = {"fastrak.port": "fastrak", "glove.port": "glove", "glove.calibration": "glove.toml"}
    client = subprocess.Popen(
        [
            *(sys.executable, "-m", "teachpath_client", "tracker", "--source", "hand", "--task", "devices"),
            *itertools.chain.from_iterable(("--option", f"{key}={tmp_path / name}") for key, name in options.items()),
            *("--option", "glove.touch=phase"),  # so that it is asked for each sample
            *("--scene", "paper", "--tracker", TRACKER, "--endpoint", service.endpoint),
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        wait_until(
            lambda: (report := recording(service)) and report.received > 5,
            f"the station receives; the client ended with {client.poll()}",
        )
        tracker.play(shown)
        assert tracker.played.wait(HANG)
        # Of a hand whose glove did not answer, because this machine stalled, no reading is sent.
        wait_until(
            lambda: (report := recording(service)) and report.demonstrations and report.received > SAMPLE_COUNT,
            "it was cut",
        )
        os.kill(client.pid, signal.SIGINT)
        out, err = client.communicate(timeout=HANG)
    finally:
        client.kill()
        client.wait(HANG)
    assert client.returncode == 0, err
    assert "Ctrl-C ends it" in err
    assert "Traceback" not in err
    assert "devices: recording: transport; 0 takes\n" in err
    assert "  + take 1 clean\n" in err
    amplitudes = glove.simulator.amplitudes
    assert [amplitude for amplitude in amplitudes if amplitude] == [128], (
        amplitudes
    )  # once, while the object was in the hand
    assert amplitudes[-1] == 0
    report = json.loads(out)
    assert (report["lost"], report["refused"], len(report["demonstrations"])) == (0, 0, 1), report
    (demonstration,) = service.station.demonstrations("devices")
    assert demonstration.verdict == "clean"
    trajectory = service.station.trajectory(demonstration.id)
    positions = np.array(trajectory.positions)
    assert np.linalg.norm(positions[0] - START) < 0.01
    assert np.linalg.norm(positions[-1] - GOAL) < 0.02
    assert np.ptp(np.array(trajectory.times)) > 3.16 - 0.5  # transport time of the hand, and what the machine adds


def test_a_demonstration_from_a_topic_of_ros_2(service: Service) -> None:
    shown = list(itertools.islice(experiment_1(), SAMPLE_COUNT))
    pose, grasp = "geometry_msgs/msg/PoseStamped", "std_msgs/msg/Bool"
    words = ["tracker", "--source", "ros2", "--option", "topic=/hand", "--option", "grasp=/closed", "--task", "ros"]
    words += ["--scene", "paper", "--tracker", TRACKER, "--endpoint", service.endpoint]
    with RmwPeer() as peer:
        peer.announce("MP", "/hand", pose)
        peer.announce("MP", "/closed", grasp, number=2)
        stamps = itertools.count(golden.STAMP_NS, round(1e9 / RATE))
        client = subprocess.Popen(
            [sys.executable, "-m", "teachpath_client", *words, "--option", f"router={peer.router}"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )

        def put(reading: HandReading) -> None:
            closed = sum(reading.flexions) / len(reading.flexions) > 0.5
            peer.put("/closed", grasp, golden.GRASP if closed else golden.OPEN_PREFIX)
            peer.put("/hand", pose, golden.posed(next(stamps), reading.position))

        def comes() -> bool:
            put(shown[0])
            report = recording(service)
            return report is not None and report.received > 5

        def is_cut() -> bool:
            put(shown[-1])
            report = recording(service)
            return report is not None and len(report.demonstrations) > 0

        try:
            wait_until(comes, f"the station receives; the client ended with {client.poll()}")
            for reading in shown:
                put(reading)
            wait_until(is_cut, "it was cut")
            os.kill(client.pid, signal.SIGINT)
            out, err = client.communicate(timeout=HANG)
        finally:
            client.kill()
            client.wait(HANG)
    assert client.returncode == 0, err
    report = json.loads(out)
    assert (report["lost"], report["refused"], len(report["demonstrations"])) == (0, 0, 1), report
    trajectory = service.station.trajectory(report["demonstrations"][0])
    assert np.linalg.norm(np.array(trajectory.positions[0]) - START) < 0.01
    assert np.linalg.norm(np.array(trajectory.positions[-1]) - GOAL) < 0.02
    steps = np.diff(np.array(trajectory.times))
    assert np.allclose(steps, 1.0 / RATE)  # as stamped by the headers, though they came as fast as they could
