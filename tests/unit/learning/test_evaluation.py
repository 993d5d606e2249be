import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath.learning.evaluation import MAX_PREDICTED, Rate, evaluate_way, predict_each, predicted_names
from teachpath.learning.settings import LearningSettings
from teachpath.records import Trajectory
from tests.unit.learning import synthetic

QUICK_SETTINGS = LearningSettings(repeats=0)


@pytest.fixture(scope="module")
def shown() -> dict[str, Trajectory]:
    rng = np.random.default_rng(4)
    return {str(number): synthetic.demonstration(rng) for number in range(5)}


@given(st.integers(1, 500).flatmap(lambda n: st.tuples(st.integers(0, n), st.just(n))))
def test_an_interval_holds_the_rate_and_is_narrower_for_ten_times_as_many(counted: tuple[int, int]) -> None:
    hits, n = counted
    low, high = Rate(hits, n).interval
    assert 0.0 <= low <= hits / n + 1e-12
    assert hits / n - 1e-12 <= high <= 1.0
    closer = Rate(10 * hits, 10 * n).interval
    assert closer[1] - closer[0] < high - low


def test_demonstrations_of_one_way_are_one_way_and_predict_each_other_better_than_a_line(
    shown: dict[str, Trajectory],
) -> None:
    steps: list[None] = []
    found = evaluate_way(shown, QUICK_SETTINGS, on_step=lambda: steps.append(None))
    assert (found.ways, found.left_out.hits, found.left_out.n, found.unpredicted) == (1, 0, 5, "")
    assert len(found.predicted) == 5
    assert all(each.rms < each.line for each in found.predicted)
    assert len(steps) == 1 + len(predicted_names(shown))


def test_each_is_predicted_without_itself(shown: dict[str, Trajectory]) -> None:
    *alike, last = shown
    bent = np.sin(np.pi * np.linspace(0, 1, len(shown[last])))[:, None] * [0.0, 0.0, 0.3]
    odd = Trajectory(shown[last].times, shown[last].positions + bent)
    predicted = predict_each({**{name: shown[name] for name in alike}, "odd": odd}, QUICK_SETTINGS)
    assert predicted[-1].rms > 0.1
    assert predicted[-1].rms > max(each.rms for each in predicted[:-1])


def test_two_demonstrations_predict_nothing_and_of_many_some_are_predicted(shown: dict[str, Trajectory]) -> None:
    two = {name: shown[name] for name in ("0", "1")}
    assert evaluate_way(two, QUICK_SETTINGS).predicted == []
    many = {str(number): shown["0"] for number in range(10 * MAX_PREDICTED)}
    names = predicted_names(many)
    assert len(set(names)) == len(names) == MAX_PREDICTED


def test_paths_of_mode_paper_are_not_adapted(shown: dict[str, Trajectory]) -> None:
    found = evaluate_way(shown, LearningSettings(mode="paper", threshold=1.0, repeats=0))
    assert (found.predicted, found.unpredicted) == ([], "")
    assert found.left_out.hits == len(shown) - 2


def test_why_nothing_is_predicted_is_said(shown: dict[str, Trajectory]) -> None:
    tiny = {name: Trajectory(each.times, 0.01 * each.positions) for name, each in shown.items()}
    found = evaluate_way(tiny, QUICK_SETTINGS)
    assert found.predicted == []
    assert "the shortest followed is" in found.unpredicted
