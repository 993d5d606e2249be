"""Tables of joint angles: the tool moves as the arm's kinematics say, and its joints are kept."""

import numpy as np
import pytest

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import FileMotions, OptionNeeded, ReadOptions
from teachpath.io.readers.registry import read_motions
from teachpath.motion.arm.kinematics import tool_pose
from teachpath.motion.arm.model import Arm
from teachpath.offline.recorded_arm import PUMA_JOINTS, kinematics_of

ARM = Arm.of_variant()
COUNT = 40
SHARE = 0.4 + np.linspace(0.0, 1.0, COUNT)[:, None] * [0.1, 0.12, 0.05, -0.1, 0.2, 0.15]  # of the joints' ranges
ANGLES = ARM.limits.lower + SHARE * (ARM.limits.upper - ARM.limits.lower)
TIMES = 0.02 * np.arange(COUNT)


def content(header: list[str], columns: np.ndarray) -> bytes:
    rows = [",".join(map(repr, row)) for row in columns.tolist()]
    return "\n".join([",".join(header), *rows, ""]).encode()


def read(raw: bytes, *, known: bool = True, **options: str) -> FileMotions:
    kinematics = kinematics_of(ARM) if known else None
    return read_motions(raw, "led.csv", "", ReadOptions(**options), ImportSettings(), kinematics)  # type: ignore[arg-type]


NAMES = {"arm": PUMA_JOINTS, **{way: [way.format(k) for k in range(1, 7)] for way in ("J{}", "q{} (rad)", "Joint {}")}}


@pytest.mark.parametrize("names", NAMES.values(), ids=NAMES)
def test_the_tool_is_where_the_arm_s_kinematics_say_and_the_joints_are_kept(names: list[str]) -> None:
    grasp = (TIMES > 0.2) & (TIMES < 0.6)
    found = read(content(["time", *names, "grasp"], np.column_stack([TIMES, ANGLES, grasp])), time_unit="s")
    (track,) = found.tracks
    np.testing.assert_allclose(track.positions, tool_pose(ANGLES, ARM)[:, :3, 3], atol=1e-12)
    np.testing.assert_array_equal(track.joints, ANGLES)
    np.testing.assert_array_equal(track.closure, grasp)
    assert "joint angles in rad" in "; ".join(found.understood)


def test_columns_may_be_in_any_order_and_in_degrees() -> None:
    order = [4, 1, 0, 5, 3, 2]
    names = [f"{PUMA_JOINTS[k]} [deg]" for k in order]
    (track,) = read(
        content(["t", *names], np.column_stack([TIMES, np.degrees(ANGLES[:, order])])), time_unit="s"
    ).tracks
    assert track.joints is not None
    np.testing.assert_allclose(track.joints, ANGLES, atol=1e-12)


def test_a_table_that_lacks_a_joint_is_asked_for_its_positions() -> None:
    with pytest.raises(OptionNeeded, match="no column for x, y, z"):
        read(content(["t", *PUMA_JOINTS[:5]], np.column_stack([TIMES, ANGLES[:, :5]])), time_unit="s")


def test_positions_count_where_a_table_has_both() -> None:
    places = np.column_stack([TIMES, 0.1 * TIMES, TIMES, TIMES])
    (track,) = read(content(["t", "x", "y", "z", *PUMA_JOINTS], np.hstack([places, ANGLES])), time_unit="s").tracks
    np.testing.assert_array_equal(track.positions, places[:, 1:])


def test_wrong_angles_are_refused_with_what_is_wrong() -> None:
    degrees = content(["t", *PUMA_JOINTS], np.column_stack([TIMES, np.degrees(ANGLES)]))
    with pytest.raises(UnusableRecording, match=r"joint1 is at .* angles in radians"):
        read(degrees, time_unit="s")
    with pytest.raises(UnusableRecording, match="no units of length"):
        read(degrees, time_unit="s", units="mm")
    holes = content(["t", *PUMA_JOINTS], np.column_stack([TIMES, np.where(TIMES[:, None] == 0.4, np.nan, ANGLES)]))
    with pytest.raises(UnusableRecording, match="joint1 is at nan"):
        read(holes, time_unit="s")
