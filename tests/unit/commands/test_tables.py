"""The table of clusters shows what selected: robust z in mode default, the log-likelihood in mode paper."""

import io

import pytest
from rich.console import Console

from teachpath.commands.tables import print_run
from teachpath.io.documents import to_document
from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath_client.models import Run
from teachpath_client.structuring import structured
from tests.unit.learning import synthetic


@pytest.mark.parametrize("mode", ["default", "paper"])
def test_it_shows_what_selects(mode: str) -> None:
    shown = synthetic.experiment_2(3)
    learned = learn(shown, LearningSettings(mode=mode, repeats=0, threshold=0.3))
    document = {"id": "run-1", "task": "demo", "created_ns": 1, "learned": to_document(learned)}
    written = io.StringIO()
    console = Console(file=written, width=100)
    print_run(structured(Run, document), {name: k for k, name in enumerate(shown, 1)}, console)
    text = written.getvalue()
    assert "Log-likelihood" in text
    assert ("Robust z" in text) == (mode == "default")
    for cluster in learned.clusters:
        for score in cluster.scores:
            assert f"{score.log_likelihood:.3f}" in text
            if mode == "default" and score.z is not None:
                assert f"{score.z:.2f}" in text
