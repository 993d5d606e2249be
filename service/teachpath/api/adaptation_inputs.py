"""The demonstrations that an adaptation rests on, read from the store."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from teachpath.api.parts import Parts
from teachpath.errors import Conflict
from teachpath.io.store.rows import Run
from teachpath.jobs.curve_assessor import Shown
from teachpath.learning.settings import settings_of_run
from teachpath.records import Demonstration, LearnedPath, Trajectory

MAX_DEMONSTRATIONS: Final = 50  # more tell nothing new of a shape, and an answer would be late


def shown_for(parts: Parts, run: Run, path: LearnedPath) -> Shown:
    """Return the selected demonstrations of a path's run that are still as they were, at most 50 of them.

    Raises:
        Conflict: none of those that the path was learned from is, or the run does not say which those were.
    """
    scores = {cluster.index: cluster.scores for cluster in run.learned.clusters}
    own = {score.demonstration for score in scores.get(path.cluster, ()) if score.selected}
    selected = {score.demonstration for of in scores.values() for score in of if score.selected}
    usable = [d for d in parts.store.demonstrations(run.task) if d.is_usable and d.id in selected]
    members = _some([d for d in usable if d.id in own], MAX_DEMONSTRATIONS)
    others = _some([d for d in usable if d.id not in own], MAX_DEMONSTRATIONS - len(members))
    unchanged = _trajectories(parts, run, members)
    if not unchanged:
        raise Conflict(
            f"the demonstrations that path {path.id} was learned from have changed or are gone; learn the task anew"
        )
    learned = parts.store.versions.get(path.id, 1)[1].curve
    return Shown(learned, unchanged, _trajectories(parts, run, others), settings_of_run(run.learned.settings))


def _some(demonstrations: Sequence[Demonstration], most: int) -> list[Demonstration]:
    """Return at most so many, evenly over their order."""
    if len(demonstrations) <= most:
        return list(demonstrations)
    return [demonstrations[i] for i in np.linspace(0, len(demonstrations) - 1, most).round().astype(int)]


def _trajectories(parts: Parts, run: Run, demonstrations: Sequence[Demonstration]) -> list[Trajectory]:
    """Return the trajectories that are those that were learned from."""
    from teachpath.learning.summary import fingerprint  # here, because it loads what clusters demonstrations

    found = ((d.id, parts.recorder.annotations.trajectory(d)) for d in demonstrations)
    return [trajectory for key, trajectory in found if fingerprint(trajectory) == run.learned.inputs.get(key)]
