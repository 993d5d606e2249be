"""What each part of the selection finds, and what it costs: rates with one part only, without it, and of the whole.

Beside the parts stands the hidden Markov model: the members that it finds less likely than the others by the same rule.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from teachpath.learning.evaluation import Rate
from teachpath.learning.selection.consistency import Part, robust_z
from teachpath.learning.selection.default_mode import measure_members
from teachpath.learning.selection.features import positions_and_velocities
from teachpath.learning.selection.likelihoods import score_likelihoods
from teachpath.learning.settings import LearningSettings
from teachpath.records import Array, Trajectory
from tests.experiments.selection_cases import CASES, FAULTLESS_CASES, FAULTY_CASES
from tests.experiments.trials import rate

MODEL = "hidden Markov model"
MODEL_SPREAD = 0.8  # nats a frame, usual spread of faultless demonstrations
PART_NAMES = (*(str(part) for part in Part), MODEL)
SETTINGS = LearningSettings()
KEPT_COUNT = SETTINGS.keep

Scores = Mapping[str, Array]  # for each part (m,)


def score_once(key: str, run: int) -> dict[str, list[float]]:
    """Return the scores of every part for one drawing of a case."""
    return scores(CASES[key].shown(np.random.default_rng([run, 17])))


def scores(shown: Sequence[Trajectory]) -> dict[str, list[float]]:
    """Return the scores of every part for demonstrations of one way."""
    z = measure_members(shown, SETTINGS)[1].scores(range(len(shown)))
    sequences = positions_and_velocities(shown)
    frames = np.array([len(sequence) for sequence in sequences])
    likelihoods = score_likelihoods(sequences, on_step=lambda: None) / frames
    model = robust_z(-likelihoods, np.full(len(shown), MODEL_SPREAD))
    return {**{str(part): values.tolist() for part, values in z.items()}, MODEL: model.tolist()}


def left_out(found: Scores, parts: Sequence[str]) -> Array:
    """Return who is left out by these parts: (m,)."""
    worst = np.max([found[part] for part in parts], axis=0)
    out = worst > SETTINGS.outlier_limit
    out[np.argsort(worst, kind="stable")[:KEPT_COUNT]] = False
    return np.asarray(out)


def summary(found: Sequence[tuple[str, dict[str, list[float]]]]) -> dict[str, Any]:
    """Return for every case the rates of the whole, without each part, and of each part alone.

    Of a faultless case the share of demonstrations left out, else how often all marked ones are.
    """
    whole = [part for part in PART_NAMES if part != MODEL]
    document: dict[str, Any] = {}
    for key, case in CASES.items():
        runs = [{part: np.array(z) for part, z in scores.items()} for name, scores in found if name == key]

        def rated(parts: Sequence[str], runs: list[dict[str, Array]] = runs, marked: int = case.marked) -> Any:
            out = [left_out(run, parts) for run in runs]
            hits = [bool(row[-marked:].all()) for row in out] if marked else [bool(one) for row in out for one in row]
            return rate(hits).document()

        document[key] = {
            "whole": rated(whole),
            "without": {part: rated([other for other in whole if other != part]) for part in whole},
            "alone": {part: rated([part]) for part in PART_NAMES},
        }
    return document


def table(found: Mapping[str, Any]) -> str:
    """Return the ablation as a table."""
    heads = "".join(f"<th>{part}" for part in PART_NAMES)
    rows = []
    for case in (*FAULTLESS_CASES, *FAULTY_CASES):
        of = found[case.key]
        whole = _revived(of["whole"])
        asked = f"≥ {case.target:.1%}" if case.marked else f"≤ {case.target:.1%}"
        alone = "".join(f"<td>{_revived(of['alone'][part]).share:.1%}" for part in PART_NAMES)
        rows.append(f"<tr><td>{case.title}<td>{asked}<td>{whole}{alone}")
        rows.append(f"<tr><td>, without<td><td>{''.join(_less(of, part, whole) for part in PART_NAMES)}")
    return (
        "<h2>What each part of the selection brings</h2>"
        "<table><caption><b>Table VII.</b> Left out by mode default: of faultless sets the share of demonstrations, of "
        "sets with a fault how often all faulty ones, with 95 % intervals; then by each part alone, and below by the "
        "whole without it. The hidden Markov model judges nothing in mode default; alone it would find this much."
        f"</caption><tr><th class=l>Five shown<th>asked<th>whole{heads}{''.join(rows)}</table>"
    )


def targets(found: Mapping[str, Any]) -> list[tuple[str, str, str, bool]]:
    """Return what is asked: what, how much, what was measured, whether it is kept."""
    rows = []
    for case in CASES.values():
        whole = _revived(found[case.key]["whole"])
        kept = whole.share >= case.target if case.marked else whole.share <= case.target
        asked = f"≥ {case.target:.1%}" if case.marked else f"≤ {case.target:.1%}"
        rows.append((f"selection: {case.title}", asked, str(whole), kept))
    return rows


def _revived(document: Mapping[str, Any]) -> Rate:
    return Rate(document["hits"], document["n"])


def _less(of: Mapping[str, Any], part: str, whole: Rate) -> str:
    if part == MODEL:
        return "<td>"
    share = _revived(of["without"][part]).share
    return f"<td>{'=' if share == whole.share else f'{share:.1%}'}"
