"""A store with a learned and planned run in which every free text is hostile, and its review."""

from dataclasses import replace

import numpy as np

from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.planning.plan import plan
from teachpath.motion.settings import MotionSettings
from teachpath.offline.report import Review, review_of
from teachpath.records import Demonstration, Trajectory
from tests.contract.rows import a_job, demonstration
from tests.unit.motion.ways import FAR_X, NEAR_X, way

HOSTILE_TEXT = "</script><script>alert(1)</script><img src=x onerror=alert(2)>\"'`&{{ 7 * 7 }}<!--"
COUNT = 8


def trajectory(shown: Demonstration) -> Trajectory:
    """One of two ways through the paper's scene, a little different each time; the seventh swings."""
    s = np.linspace(0.0, 1.0, 120)
    points = way(NEAR_X if shown.number % 2 else FAR_X).curve(s)
    sway = 0.003 * np.sin(7.0 * shown.number + 3.0 * s) + (0.012 * np.sin(25.0 * s) if shown.number == 7 else 0.0)
    return Trajectory(3.0 * s, points + (sway * np.sin(np.pi * s) ** 2)[:, None] * [0.5, 0.0, 1.0])


def learned_store(folder: str) -> Store:
    """Return a store with task `t`, learned, the first of its paths planned; nothing was learned of `unlearned`."""
    store = Store(StoreSettings(folder))
    for name in ("t", "unlearned"):
        store.ensure_task(name, scene="paper", calibration="identity")
    shown = [
        store.add_demonstration(demonstration(f"d{i}", source=HOSTILE_TEXT, reasons=(HOSTILE_TEXT,)))
        for i in range(COUNT)
    ]
    store.add_job(a_job("learn-1"))
    found = learn({d.id: trajectory(d) for d in shown}, LearningSettings(repeats=1))
    store.finish_learning("learn-1", replace(found, notes=(HOSTILE_TEXT,)))
    run = store.newest_run("t")
    assert run is not None
    path = run.learned.paths[0]
    store.add_job(a_job("plan-1", kind="plan", request={"path": path.id, "version": path.version}))
    store.finish_planning("plan-1", plan(path, paper_scene(), plan_id="plan-1"))
    return store


def review(store: Store, what: str = "t", *, arm: Arm | None = None) -> Review:
    """Return a review by default settings, for the arm that was planned for unless another is given."""
    return review_of(
        store,
        what,
        scene=lambda name: paper_scene(),
        trajectory=trajectory,
        motion=MotionSettings(),
        arm=arm or Arm.of_variant(),
        robot="puma560",
        dwell=0.5,
    )
