"""Nonsense in the settings is refused with the name, the value and the limit."""

from __future__ import annotations

import pytest

from teachpath.errors import UnusableSettings
from teachpath.learning.settings import LearningSettings


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"mode": "magic"}, "'magic'; it is one of default, paper, repaired"),
        ({"metric": "hausdorff"}, "'hausdorff'; it is one of arc, frechet, dtw, undersampled"),
        ({"mode": "repaired"}, "learning.threshold in metres"),
        ({"clusters": 0}, "clusters is 0; it is at least 1"),
        ({"repeats": -1}, "repeats is -1; it is at least 0"),
        ({"turn_bound": 0.0}, "greater than 0"),
        ({"mode": "paper"}, "learning.threshold in metres"),
        ({"keep": 0}, "keep is 0; it is at least 1"),
        ({"keep": 1.5}, "whole number"),
        ({"keep": True}, "whole number"),
        ({"threshold": 0.0}, "greater than 0"),
        ({"threshold": "far"}, "it is a number"),
        ({"error_bound": float("nan")}, "finite"),
        ({"error_bound": float("inf")}, "finite"),
        ({"error_bound": -0.001}, "greater than 0"),
        ({"degree": 8}, "at most 7"),
        ({"min_separation": 0.5}, "at least 1"),
        ({"outlier_limit": 0.0}, "greater than 0"),
    ],
)
def test_a_setting_outside_its_limits_is_refused(change: dict[str, object], sentence: str) -> None:
    with pytest.raises(UnusableSettings, match=sentence):
        LearningSettings(**change)  # type: ignore[arg-type]


def test_limits_themselves_are_allowed() -> None:
    settings = LearningSettings(
        mode="paper", threshold=1e-6, keep=1, degree=7, min_separation=1.0, outlier_limit=1e-6, seed=0
    )
    assert settings.degree == 7
