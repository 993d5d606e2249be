"""How long the demo's twelve demonstrations take to learn, and each of their paths to plan, in this process."""

from functools import partial

import numpy as np

from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import Learned, Trajectory
from tests.bench.learning_peers import timed
from tests.bench.report import Figure, against


def measure(trajectories: dict[str, Trajectory], *, repeats: int) -> list[Figure]:
    """Return the figures; each is measured after one run that does not count."""
    learned = learn(trajectories, LearningSettings())
    shown = sum(float(t.times[-1]) for t in trajectories.values())
    lengths = [len(t) for t in trajectories.values()]
    what = f"learning {len(lengths)} x {round(np.mean(lengths))} samples, {len(learned.paths)} paths"
    seconds = timed(lambda: learn(trajectories, LearningSettings()), repeats)
    return [
        against(what, seconds, "s", name="time it took to show", value=shown),
        *_planning(learned, repeats),
    ]


def _planning(learned: Learned, repeats: int) -> list[Figure]:
    figures = []
    for path in learned.paths:
        planned = plan(path, paper_scene(), MotionSettings())
        seconds = timed(partial(plan, path, paper_scene(), MotionSettings()), repeats)
        what = f"planning path {path.cluster} with its certificate"
        figures.append(against(what, seconds, "s", name="time the arm needs for it", value=planned.duration))
    return figures
