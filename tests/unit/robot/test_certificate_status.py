"""What the service answers when the executor asks whether a certificate still holds."""

from collections.abc import Iterator
from dataclasses import replace

import pytest

from teachpath.errors import NotFound, PathRefused
from teachpath.io.documents import encode
from teachpath.io.memory_bus import MemoryBus
from teachpath.io.store.store import Store
from teachpath.records import Calibration, CertificateQuery, Job, JobState, ObjectPose, Plan, Scene, Signature
from teachpath.robot.certificate_status import CertificateStatus
from teachpath_proto.keys import Keys
from tests.unit.io.test_documents import a_plan

KEYS = Keys()
LAB = Calibration("lab@1", offset=(0.1, 0.0, 0.0))
SIGNATURE = Signature("puma", 0.1, {}, (LAB,), (LAB,), 1, 2, "ab")


class Station:
    """A store, scenes and calibrations that change, and the question of an executor."""

    def __init__(self, store: Store) -> None:
        self.store = store
        self.bus = MemoryBus()
        self.scenes = {"s": a_plan().scene}
        self.calibrations = {"lab": LAB}
        status = CertificateStatus(self.bus, KEYS, store, scene=self.scene, calibration=self.current)
        self.start, self.stop = status.start, status.stop

    def scene(self, name: str) -> Scene:
        if name not in self.scenes:
            raise NotFound(f"there is no scene {name!r}")
        return self.scenes[name]

    def current(self, calibration: Calibration) -> Calibration:
        return self.calibrations[calibration.name.partition("@")[0]]

    def keep(self, plan: Plan) -> None:
        self.store.add_job(Job(f"job-{plan.id}", "t", "plan", {}, JobState.QUEUED, 0.0, "", "", 0, 1, 0))
        self.store.finish_planning(f"job-{plan.id}", plan)

    def ask(self, plan: str = "id", mac: str = "ab") -> bytes:
        return self.bus.ask(KEYS.station_certificate, encode(CertificateQuery(plan, mac)))

    def refusal(self, plan: str = "id", mac: str = "ab") -> str:
        with pytest.raises(PathRefused) as refused:
            self.ask(plan, mac)
        assert plan in str(refused.value)
        return str(refused.value)


@pytest.fixture
def station(store: Store) -> Iterator[Station]:
    station = Station(store)
    store.ensure_task("t", scene="s", calibration="lab")
    plan = a_plan()
    station.keep(replace(plan, certificate=replace(plan.certificate, signature=SIGNATURE)))
    station.start()
    yield station
    station.stop()


def test_a_certificate_that_holds_is_answered_by_the_question(station: Station) -> None:
    assert station.ask() == encode(CertificateQuery("id", "ab"))


def test_the_same_mapping_measured_again_changes_nothing(station: Station) -> None:
    station.calibrations["lab"] = replace(LAB, name="lab@2")
    station.ask()


def test_a_revoked_one_is_refused_with_the_reason(station: Station) -> None:
    station.store.journal.revoke("id", who="Ada", reason="the table was moved")
    assert "was revoked: the table was moved; plan the path again" in station.refusal()


def test_a_plan_that_is_not_stored_here_or_otherwise_is_refused(station: Station) -> None:
    assert "stored no plan 'moon'; plan the path again here" in station.refusal("moon")
    assert "another signature" in station.refusal(mac="cd")
    station.keep(replace(a_plan(), id="unsigned"))
    assert "another signature" in station.refusal("unsigned")


def test_a_scene_that_has_changed_or_gone_is_refused(station: Station) -> None:
    station.scenes["s"] = replace(station.scenes["s"], obstacles=())
    assert "scene s has changed since id was certified; plan the path again" in station.refusal()
    station.scenes.clear()
    assert "there is no scene 's'; make that scene again" in station.refusal()


def test_an_object_that_lies_elsewhere_is_named_with_both_places(station: Station) -> None:
    scene = station.scenes["s"]
    assert scene.carried is not None
    station.scenes["s"] = scene.with_object(ObjectPose((0.5, 0.25, 0.52)))
    said = station.refusal()
    assert f"takes {scene.carried.name} at" in said
    assert "it lies at 0.500, 0.250, 0.520; put it there and say so (teachpath object s --at x,y,z)" in said
    assert "teachpath run PATH --adapt" in said


@pytest.mark.parametrize(
    ("now", "sentence"),
    [
        (replace(LAB, name="lab@2", scale=2.0), "calibration lab@1 has been measured anew (lab@2)"),
        (replace(LAB, scale=2.0), "calibration lab@1 has been set otherwise"),
    ],
)
def test_a_calibration_that_is_another_now_is_refused_with_both_ways_out(
    station: Station, now: Calibration, sentence: str
) -> None:
    station.calibrations["lab"] = now
    said = station.refusal()
    assert sentence in said
    assert "teachpath recalibrate" in said
    assert "plan the path again" in said
