"""Trajectories from arrays, rows and tables; and what is said of those that are none."""

from typing import Any

import numpy as np
import pytest

from teachpath.errors import UnusableInput
from teachpath.records import Trajectory
from teachpath.trajectories import DEFAULT_DT, to_trajectories, to_trajectory

N = 20
RAMP = np.linspace(0.0, 1.0, N)
POINTS = np.column_stack([0.5 + 0.1 * RAMP, 0.3 * RAMP, 0.6 + 0.0 * RAMP])
TURNED_QUATERNIONS = np.column_stack([np.cos(RAMP), np.sin(RAMP), 0.0 * RAMP, 0.0 * RAMP])


class Column:
    """A column of a table, as data frames have them."""

    def __init__(self, values: Any) -> None:
        self._values = values

    def to_numpy(self) -> Any:
        return self._values


class Table:
    """A table with named columns, as data frames are."""

    def __init__(self, **columns: Any) -> None:
        self._columns = columns
        self.columns = list(columns)

    def __getitem__(self, name: str) -> Column:
        return Column(self._columns[name])


def table(**more: Any) -> Table:
    return Table(**dict(zip("xyz", POINTS.T, strict=True)), **more)


@pytest.mark.parametrize(
    "given",
    [
        POINTS,
        POINTS.tolist(),
        POINTS.astype(np.float32),
        table(),
        table(flexion=RAMP),
        {"x": POINTS[:, 0], "y": POINTS[:, 1].tolist(), "z": POINTS[:, 2]},
        Trajectory(np.arange(N) * DEFAULT_DT, POINTS),
    ],
    ids=["array", "rows", "float32", "table", "wide table", "mapping", "trajectory"],
)
def test_whatever_holds_the_positions_gives_them(given: Any) -> None:
    made = to_trajectory(given)
    np.testing.assert_allclose(made.positions, POINTS, atol=1e-6)
    np.testing.assert_allclose(made.times, np.arange(N) * DEFAULT_DT)
    assert made.orientations is None


@pytest.mark.parametrize(
    "given",
    [
        np.column_stack([POINTS, TURNED_QUATERNIONS]),
        table(**dict(zip(("qw", "qx", "qy", "qz"), TURNED_QUATERNIONS.T, strict=True))),
        Trajectory(np.arange(N) * DEFAULT_DT, POINTS, TURNED_QUATERNIONS),
    ],
    ids=["array", "table", "trajectory"],
)
def test_orientations_come_with_them(given: Any) -> None:
    orientations = to_trajectory(given).orientations
    assert orientations is not None
    np.testing.assert_allclose(orientations, TURNED_QUATERNIONS, atol=1e-9)


def test_neighbouring_quaternions_lie_on_one_half_of_the_sphere() -> None:
    signs = np.where(np.arange(N) % 3, 1.0, -1.0)[:, None]
    orientations = to_trajectory(np.column_stack([POINTS, 1.004 * signs * TURNED_QUATERNIONS])).orientations
    assert orientations is not None
    assert (np.sum(orientations[1:] * orientations[:-1], axis=1) > 0).all()
    np.testing.assert_allclose(np.linalg.norm(orientations, axis=1), 1.0)
    np.testing.assert_allclose(orientations, -TURNED_QUATERNIONS, atol=1e-9)  # the first one keeps its sign


@pytest.mark.parametrize(
    ("given", "options"),
    [
        (POINTS, {"dt": 0.1}),
        (POINTS, {"times": 7.0 + 0.1 * np.arange(N)}),
        (POINTS, {"times": (7.0 + 0.1 * np.arange(N)).tolist()}),
        (table(t=7.0 + 0.1 * np.arange(N)), {}),
        (table(time=np.datetime64("2026-01-01") + np.arange(N) * np.timedelta64(100, "ms")), {}),
        (Trajectory(7.0 + 0.1 * np.arange(N), POINTS), {}),
    ],
    ids=["dt", "times", "list", "column", "dates", "trajectory"],
)
def test_times_begin_at_0_wherever_they_come_from(given: Any, options: Any) -> None:
    np.testing.assert_allclose(to_trajectory(given, **options).times, 0.1 * np.arange(N), atol=1e-9)


def changed(row: int, column: int, value: float) -> np.ndarray:
    points = POINTS.copy()
    points[row, column] = value
    return points


@pytest.mark.parametrize(
    ("given", "options", "sentence"),
    [
        (POINTS.T, {}, r"has the shape \(3, 20\), not \(n, 3\).*transpose it"),
        (POINTS[:, :2], {}, r"shape \(20, 2\), not \(n, 3\) of x, y, z \[m\] or \(n, 7\)"),
        (POINTS[0], {}, r"shape \(3,\), not"),
        (0.5, {}, r"shape \(\), not"),
        ([[0.5, 0.1, 0.6], [0.5, 0.1]], {}, "no array of numbers .* rows of one length"),
        ([["a", "b", "c"]], {}, "holds str.* values, e.g. .*'a'.*; give numbers"),
        (POINTS + 1j, {}, "holds complex128 values"),
        (changed(7, 1, np.nan), {}, r"demonstration 1: row 7 of 20 \(.*nan.*\) is not finite; leave the row out"),
        (changed(3, 2, -np.inf), {}, "row 3 of 20 .* is not finite"),
        (
            1000 * POINTS,
            {},
            "row 0 of 20 .* is farther than 10 m from the robot; give metres: divide millimetres by 1000",
        ),
        (1e6 * POINTS, {}, "farther than 10 m"),
        (np.column_stack([POINTS, 2 * TURNED_QUATERNIONS]), {}, "row 0 .* a quaternion that is not of length 1"),
        (np.column_stack([POINTS, 0 * TURNED_QUATERNIONS]), {}, "a quaternion that is not of length 1"),
        (POINTS, {"dt": 0.0}, "dt is 0 s; it is greater than 0"),
        (POINTS, {"dt": np.nan}, "dt is nan s"),
        (POINTS, {"dt": 0.1, "times": RAMP}, "has times, and dt = 0.1 s is given too"),
        (POINTS, {"times": RAMP[:-1]}, r"has 20 samples and times of shape \(19,\)"),
        (POINTS, {"times": -RAMP}, "row 1 of 20 at .* does not come later than the one before; sort by time"),
        (POINTS, {"times": 0 * RAMP}, "row 1 .* does not come later"),
        (POINTS, {"times": RAMP * np.nan}, "row 0 .* does not come later"),
        (POINTS, {"times": 1e5 * RAMP}, "lasts 100000 s, limit 3600; give seconds: divide milliseconds by 1000"),
        (table(t=RAMP), {"times": RAMP}, "has times of its own"),
        (table(t=RAMP), {"dt": 0.1}, "has times, and dt"),
        (Table(X=RAMP, Y=RAMP, Z=RAMP), {}, "has no column x; it has X, Y, Z, and needs x, y, z"),
        (table(qw=RAMP), {}, "has no column qx"),
        (table(t=["now"] * N), {}, "column t holds str"),
        (Trajectory(RAMP, POINTS[:-1]), {}, r"19 samples and times of shape \(20,\)"),
    ],
)
def test_what_is_no_trajectory_is_refused_with_value_limit_place_and_way_out(
    given: Any, options: Any, sentence: str
) -> None:
    with pytest.raises(UnusableInput, match=sentence) as refused:
        to_trajectory(given, **options)
    assert "demonstration 1" in str(refused.value) or "dt is" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_demonstrations_are_named_by_their_numbers_or_by_their_names() -> None:
    assert list(to_trajectories([POINTS, table()])) == ["1", "2"]
    assert list(to_trajectories(np.stack([POINTS, POINTS]))) == ["1", "2"]
    assert list(to_trajectories(iter([POINTS]))) == ["1"]
    assert list(to_trajectories({"left": POINTS, "right": POINTS})) == ["left", "right"]
    made = to_trajectories({"left": POINTS, "right": POINTS}, times={"right": 2 * RAMP, "left": RAMP})
    assert made["right"].times[-1] == 2.0
    with pytest.raises(UnusableInput, match="demonstration 2: row 0"):
        to_trajectories([POINTS, 1000 * POINTS])
    with pytest.raises(UnusableInput, match="times of 1 do not belong to the demonstrations 1, 2"):
        to_trajectories([POINTS, POINTS], times=[RAMP])


@pytest.mark.parametrize("given", [POINTS, table(), Trajectory(RAMP, POINTS), 7])
def test_one_demonstration_is_no_list_of_them(given: Any) -> None:
    with pytest.raises(UnusableInput, match="a list of demonstrations is needed"):
        to_trajectories(given)


def test_what_was_given_is_not_changed_and_not_kept() -> None:
    given = POINTS.copy()
    made = to_trajectory(given)
    given[:] = 0.0
    np.testing.assert_array_equal(made.positions, POINTS)
