import pytest

from teachpath.recording.guidance import ClusterSummary, advise

LENGTH = 0.7  # m


@pytest.mark.parametrize(
    ("clusters", "sentence"),
    [
        ([], ""),
        ([ClusterSummary(0, 0.0)], ""),
        ([ClusterSummary(1, 0.0)], "one demonstration so far; show it again"),
        ([ClusterSummary(2, 0.012)], "2 demonstrations agree within 1.2 cm; there are only two, show it again"),
        ([ClusterSummary(4, 0.012)], "4 demonstrations agree within 1.2 cm"),
        (
            [ClusterSummary(4, 0.012), ClusterSummary(2, 0.008)],
            "6 demonstrations show 2 ways and agree within 1.2 cm; the second way has only two, show it again",
        ),
        (
            [ClusterSummary(2, 0.004), ClusterSummary(1, 0.0)],
            "3 demonstrations show 2 ways and agree within 4 mm; the second way has only one, show it again",
        ),
        (
            [ClusterSummary(1, 0.0), ClusterSummary(1, 0.0)],
            "2 demonstrations show 2 ways; the first way has only one, show it again",
        ),
        ([ClusterSummary(3, 0.01)] * 3, "9 demonstrations show 3 ways and agree within 1 cm"),
        ([ClusterSummary(3, 0.241)], "3 demonstrations are up to 25 cm apart, discard what you did not mean"),
        (
            [ClusterSummary(3, 0.01), ClusterSummary(3, 0.2)],
            "6 demonstrations show 2 ways; some of one way are up to 20 cm apart, discard what you did not mean",
        ),
    ],
)
def test_the_advice_says_what_agrees_and_what_to_show_again(clusters: list[ClusterSummary], sentence: str) -> None:
    assert advise(clusters, LENGTH) == sentence


@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
def test_whether_they_agree_does_not_depend_on_the_size_of_the_task(scale: float) -> None:
    assert "agree" in advise([ClusterSummary(3, 0.08 * scale)], LENGTH * scale)
    assert "apart" in advise([ClusterSummary(3, 0.24 * scale)], LENGTH * scale)
