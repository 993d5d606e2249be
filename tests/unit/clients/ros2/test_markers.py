"""Tasks as markers, and executions as trajectories: what ROS 2 reads is what the station has."""

from pathlib import Path
from typing import Any

import numpy as np

from teachpath.io import wire
from teachpath.io.store.motions import MotionHeader, MotionTake
from teachpath.records import JointState
from teachpath_client.ros2.executed import executed_trajectory
from teachpath_client.ros2.markers import DELETE_ALL, LINE_STRIP, Polyline, markers
from teachpath_client.ros2.messages import MARKERS, TRAJECTORY, decode, encode, stamp_of
from teachpath_client.ros2.trajectories import read_trajectory
from tests.unit.clients.ros2 import golden
from tests.unit.clients.ros2.test_readings import NAMES

PERIOD_NS = 4_000_000
COUNT = 60


def test_the_first_marker_deletes_what_was_shown_byte_by_byte() -> None:
    assert encode(MARKERS, markers=markers([], "world")) == golden.NO_MARKERS


def test_a_line_has_its_points_in_the_world() -> None:
    points = np.random.default_rng(1).normal(size=(7, 3)).tolist()
    line = Polyline("cup/paths", "2", points, (0.0, 0.25, 0.5, 1.0), 0.006)
    first, *shown = decode(MARKERS, encode(MARKERS, markers=markers([line, line], "world"))).markers
    assert first.action == DELETE_ALL
    assert [(each.ns, each.id, each.type, each.text) for each in shown] == [
        ("cup/paths", number, LINE_STRIP, "2") for number in range(2)
    ]
    for each in shown:
        assert each.header.frame_id == "world"
        assert [[point.x, point.y, point.z] for point in each.points] == points
        assert (each.scale.x, each.color.g, each.color.a, each.pose.orientation.w) == (0.006, 0.25, 1.0, 1.0)


def states() -> list[JointState]:
    values = np.random.default_rng(2).normal(size=(COUNT, 3, 6))
    place = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
    return [
        JointState(golden.STAMP_NS + number * PERIOD_NS, number, *rows, 0.0, 0, False, False, *place)
        for number, rows in enumerate(values)
    ]


def recording(folder: Path, payloads: list[bytes]) -> bytes:
    take = MotionTake(folder / "e.mcap.part", MotionHeader("e", "arm"))
    for payload in payloads:
        take.write("states", payload, golden.STAMP_NS)
    return take.finish({}).read_bytes()


def read_back(fields: dict[str, Any] | None) -> Any:
    assert fields is not None
    return decode(TRAJECTORY, encode(TRAJECTORY, **fields))


def test_an_execution_has_every_joint_state_at_its_time(tmp_path: Path) -> None:
    measured = states()
    message = read_back(executed_trajectory(recording(tmp_path, list(map(wire.encode_state, measured))), NAMES))
    assert stamp_of(message.header) == golden.STAMP_NS  # long ago, so that no controller begins it
    motion = read_trajectory(message, NAMES)
    assert np.round(motion.times * 1e9).astype(int).tolist() == [number * PERIOD_NS for number in range(COUNT)]
    assert motion.velocities is not None
    assert motion.positions.tobytes() == np.array([state.position for state in measured]).tobytes()
    assert motion.velocities.tobytes() == np.array([state.velocity for state in measured]).tobytes()
    efforts = np.array([point.effort for point in message.points])
    assert efforts.tobytes() == np.array([state.torque for state in measured]).tobytes()


def test_of_many_joint_states_even_ones_are_taken(tmp_path: Path) -> None:
    content = recording(tmp_path, list(map(wire.encode_state, states())))
    times = read_trajectory(read_back(executed_trajectory(content, NAMES, most=25)), NAMES).times
    assert len(times) == 20
    assert np.allclose(np.diff(times), 3e-9 * PERIOD_NS)


def test_of_a_torn_recording_what_is_whole_is_taken(tmp_path: Path) -> None:
    content = recording(tmp_path, list(map(wire.encode_state, states())))
    whole = read_back(executed_trajectory(content, NAMES))
    for size in range(0, len(content), 101):
        fields = executed_trajectory(content[:size], NAMES)
        if fields is not None:
            positions = [point.positions.tobytes() for point in read_back(fields).points]
            assert positions == [point.positions.tobytes() for point in whole.points[: len(positions)]]


def test_states_of_other_joints_repeated_ones_and_none_at_all_are_no_points(tmp_path: Path) -> None:
    first = wire.encode_state(states()[0])
    message = read_back(executed_trajectory(recording(tmp_path, [first, first]), NAMES))
    assert len(message.points) == 1
    (tmp_path / "e.mcap").unlink()
    content = recording(tmp_path, [first])
    assert executed_trajectory(content, NAMES[:5]) is None
    assert executed_trajectory(b"", NAMES) is None
