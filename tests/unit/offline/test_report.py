"""The review package: what it holds, that it fetches nothing, and that nothing of it can break out of its place."""

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import umsgpack
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.errors import NotFound, UnusableInput
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.learning.learn import learn
from teachpath.learning.settings import LearningSettings
from teachpath.live.preview.commands import pose_of
from teachpath.motion.arm.model import Arm
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.settings import MotionSettings
from teachpath.offline.report import Review, review_of, write
from teachpath.offline.report.scene import scene_batch
from teachpath.records import Demonstration, Deviation, Scene, Shape, Trajectory
from tests.contract.rows import a_job, demonstration

HOME = np.array(MotionSettings().home)
NASTY = "</script><script>alert(1)</script>"


def trajectory(shown: Demonstration) -> Trajectory:
    t = np.linspace(0.0, 1.0, 120)
    swing = (0.2 if shown.number % 2 else -0.1) + 0.004 * np.sin(7.0 * shown.number + 3 * t)
    return Trajectory(3.0 * t, np.column_stack([0.35 + swing * np.sin(np.pi * t), 0.5 * t - 0.25, np.full(120, 0.6)]))


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    store = learned(Store(StoreSettings(str(tmp_path_factory.mktemp("report")))))
    yield store
    store.close()


def learned(store: Store) -> Store:
    for name in ("t", "unlearned"):
        store.ensure_task(name, scene="paper", calibration="identity")
    shown = [store.add_demonstration(demonstration(f"d{i}", source=NASTY)) for i in range(8)]
    store.add_job(a_job("learn-1"))
    store.finish_learning("learn-1", learn({d.id: trajectory(d) for d in shown}, LearningSettings(repeats=1)))
    return store


def review(store: Store, what: str = "t") -> Review:
    return review_of(
        store,
        what,
        scene=lambda name: paper_scene(),
        trajectory=trajectory,
        motion=MotionSettings(),
        arm=Arm.of_variant(),
        dwell=0.5,
    )


def test_it_holds_every_way_demonstration_and_reason_and_fetches_nothing(store: Store, tmp_path: Path) -> None:
    found = review(store)
    size = write(found, tmp_path / "r.html", home=HOME)
    text = (tmp_path / "r.html").read_text()
    assert len(text.encode()) == size
    assert text.count('class="mark"') >= 2 * len(found.run.learned.clusters)
    assert all(digest in text for digest in found.run.learned.inputs.values())
    assert "Content-Security-Policy" in text
    outside = re.sub(r"<script.*?</script>", "", text, flags=re.S)
    assert not re.findall(r"""(?:src|href)\s*=|url\(|@import""", outside)


def test_the_scene_is_drawn_as_it_stands_and_deviations_where_they_are(store: Store) -> None:
    found = review(store)
    corners = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    wedge = Shape("wedge", "mesh", (0.1,), (0.3, 0.2, 0.4), orientation=(0.6, 0.0, 0.8, 0.0), vertices=corners)
    cluster = found.run.learned.clusters[0]
    departed = replace(cluster.scores[0], deviation=Deviation((0.25, 0.5), (0.0, 1.0), ""))
    clusters = (replace(cluster, scores=(departed,)),)
    run = replace(found.run, learned=replace(found.run.learned, clusters=clusters))
    found = replace(found, scene=Scene("turned", (wedge,)), run=run)
    drawn = {}
    batch = scene_batch(found, HOME)
    while batch:
        length = int.from_bytes(batch[:4], "little")
        command = umsgpack.unpackb(batch[4 : 4 + length])
        drawn[command["path"]] = command
        batch = batch[4 + length :]
    pose = np.reshape(drawn["/scene/wedge"]["object"]["object"]["matrix"], (4, 4)).T
    np.testing.assert_allclose(pose, pose_of(wedge.position, wedge.orientation), atol=1e-12)
    assert f"/departures/{departed.demonstration}" in drawn
    assert sum(path.startswith("/departures") for path in drawn) == 1


def test_a_name_that_is_a_script_stays_a_name(store: Store, tmp_path: Path) -> None:
    write(review(store), tmp_path / "r.html", home=HOME)
    text = (tmp_path / "r.html").read_text()
    assert NASTY not in text
    assert "&lt;script&gt;alert(1)" in text
    assert text.count("</script>") == text.count("<script") == 3


def test_a_run_is_found_by_its_id_too_and_what_is_missing_is_named(store: Store) -> None:
    assert review(store, "run-1").run.id == review(store).run.id
    with pytest.raises(NotFound, match="there is no run 'run-9'"):
        review(store, "run-9")
    with pytest.raises(NotFound, match="nothing was learned of task unlearned yet"):
        review(store, "unlearned")


def test_a_file_that_is_there_stays_as_it_is(store: Store, tmp_path: Path) -> None:
    (tmp_path / "r.html").write_text("mine")
    with pytest.raises(UnusableInput, match="is there already"):
        write(review(store), tmp_path / "r.html", home=HOME)
    with pytest.raises(UnusableInput, match="cannot write"):
        write(review(store), tmp_path / "none" / "r.html", home=HOME)
    assert [file.name for file in tmp_path.iterdir()] == ["r.html"]
    assert (tmp_path / "r.html").read_text() == "mine"


def test_a_demonstration_that_is_gone_is_shown_as_such(store: Store) -> None:
    found = review(store)
    without = replace(found, demonstrations=found.demonstrations[1:])
    assert without.number(found.demonstrations[0].id) == 0


def test_export_writes_a_package_of_a_whole_run_only(tmp_path: Path) -> None:
    learned(Store(StoreSettings(str(tmp_path / "data")))).close()
    (tmp_path / "file").write_text("mine")
    refusals = [
        (["unlearned"], NotFound, "nothing was learned of task unlearned yet"),
        (["t", "--all"], UnusableInput, "a whole run"),
        (["t", "--number", "1"], UnusableInput, "a whole run"),
        (["t", "--format", "csv"], UnusableInput, "a whole run"),
        (["t", "--into", str(tmp_path / "file")], UnusableInput, "cannot make"),
    ]
    for words, kind, sentence in refusals:
        into = [] if "--into" in words else ["--into", str(tmp_path / "out")]
        data = str(tmp_path / "data")
        refused = CliRunner().invoke(app, ["export", "--report", *words, *into, "--data", data]).exception
        assert isinstance(refused, kind)
        assert sentence in str(refused)
    assert not list((tmp_path / "out").iterdir())
