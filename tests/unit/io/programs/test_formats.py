"""Motions as tables, ROS 2 messages and bags: what is read back is what was written."""

import io
import json
import math

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from teachpath.errors import UnusableInput
from teachpath.io.programs.formats import MAX_POINTS, check_rate, format_named
from teachpath.io.programs.joint_trajectory import joint_trajectory_cdr
from teachpath.io.setpoints import read_setpoints
from tests.unit.io.programs.motions import a_motion

MOTION = a_motion()


def written(name: str) -> bytes:
    return format_named(name).write(MOTION)


def test_a_table_holds_every_number_to_the_last_bit() -> None:
    lines = written("csv").decode().splitlines()
    remarks = [line[2:] for line in lines if line.startswith("#")]
    assert remarks[: len(MOTION.notes)] == list(MOTION.notes)
    rows = np.loadtxt(lines[len(remarks) + 1 :], delimiter=",")
    expected = np.column_stack([MOTION.times, MOTION.positions, MOTION.velocities, MOTION.accelerations])
    assert rows.tobytes() == expected.tobytes()


def test_a_table_is_a_log_that_can_be_checked() -> None:
    times, positions, on_path = read_setpoints(written("csv"), "p.csv")
    assert (times.tobytes(), positions.tobytes(), on_path) == (MOTION.times.tobytes(), MOTION.positions.tobytes(), None)


def test_json_is_the_message_with_its_notes_beside_it() -> None:
    document = json.loads(written("json"))
    assert document["notes"] == list(MOTION.notes)
    message = document["joint_trajectory"]
    assert message["joint_names"] == [f"joint{number}" for number in range(1, 7)]
    for name in ("positions", "velocities", "accelerations"):
        assert np.array([point[name] for point in message["points"]]).tobytes() == getattr(MOTION, name).tobytes()
    clock = [point["time_from_start"] for point in message["points"]]
    assert all(0 <= each["nanosec"] < 10**9 for each in clock)
    np.testing.assert_allclose([t["sec"] + t["nanosec"] / 1e9 for t in clock], MOTION.times, rtol=0, atol=0.5e-9)


def test_ros_2_reads_from_the_bag_what_stands_in_the_json() -> None:
    reader = make_reader(io.BytesIO(written("mcap")), decoder_factories=[DecoderFactory()])
    assert reader.get_header().profile == "ros2"
    ((schema, channel, stored, message),) = list(reader.iter_decoded_messages())
    assert (schema.name, schema.encoding) == ("trajectory_msgs/msg/JointTrajectory", "ros2msg")
    assert (channel.topic, channel.message_encoding) == ("/joint_trajectory", "cdr")
    assert (stored.log_time, stored.data) == (MOTION.stamp_ns, joint_trajectory_cdr(MOTION))
    expected = json.loads(written("json"))["joint_trajectory"]
    assert list(message.joint_names) == expected["joint_names"]
    assert len(message.points) == len(expected["points"])
    for point, wanted in zip(message.points, expected["points"], strict=True):
        for name in ("positions", "velocities", "accelerations", "effort"):
            assert list(getattr(point, name)) == wanted[name]
        duration = point.time_from_start
        assert {"sec": duration.sec, "nanosec": duration.nanosec} == wanted["time_from_start"]
    (metadata,) = list(reader.iter_metadata())
    assert tuple(metadata.metadata.values()) == MOTION.notes


@pytest.mark.parametrize("name", ["csv", "json", "cdr", "mcap"])
def test_a_motion_that_stands_still_can_be_written(name: str) -> None:
    assert format_named(name).write(a_motion(1))


@pytest.mark.parametrize("rate", [0.0, -1.0, math.nan, math.inf, 1e9, 0.999])
def test_a_rate_that_cannot_be_is_a_sentence(rate: float) -> None:
    with pytest.raises(UnusableInput, match=rf"a rate of {rate:g} Hz is outside 1 to 10000".replace("+", r"\+")):
        check_rate(rate, 5.0)


def test_a_file_of_too_many_points_is_refused_with_the_rate_that_is_not() -> None:
    with pytest.raises(UnusableInput, match=r"ask for (\d+) Hz or fewer") as refused:
        check_rate(10_000.0, 47.0)
    rate = int(str(refused.value).split("ask for ")[1].split()[0])
    check_rate(float(rate), 47.0)
    assert 47.0 * (rate + 1) > MAX_POINTS


def test_an_unknown_format_is_refused_with_those_that_are_known() -> None:
    with pytest.raises(
        UnusableInput, match=r"no format 'xls' of motions; known: csv, json, cdr, mcap, urscript, rapid, krl, ls"
    ):
        format_named("xls")
