"""Jobs, their outcomes and executions over REST."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pytest

from teachpath.api.work import NewJob
from teachpath.app import Station
from teachpath.io.documents import decode, encode
from teachpath.io.wire import decode_command, encode_status
from teachpath.motion.collision.builtin_scenes import empty_scene
from teachpath.records import CertificateQuery, ExecutorStatus, Job, JobState, Plan, Scene, Signature
from teachpath_proto.control import CommandVerb
from teachpath_proto.keys import name_refusal
from tests.contract.desk import API, Desk, csv, refused
from tests.unit.io.test_documents import a_plan


def planned(station: Station, key: str, scene: Scene | None = None) -> str:
    """Store a plan, as signed, and return its id."""
    job = Job(f"plan-{key}", "t", "plan", {}, JobState.QUEUED, 0.0, "", "", 0, 1, 0)
    station.store.add_job(job)
    plan = a_plan()
    signature = Signature("puma", 0.1, {}, (), (), 1, 2, "ab")
    signed = replace(
        plan, id=key, scene=scene or empty_scene(), certificate=replace(plan.certificate, signature=signature)
    )
    return station.store.finish_planning(job.id, signed)


@contextmanager
def asking_executor(station: Station) -> Iterator[None]:
    """Answer starts as an executor does that finds every signature good: by what the service says of the plan."""

    def answer(payload: bytes) -> bytes:
        command = decode_command(payload)
        if command.verb is CommandVerb.REVOKE:
            return encode_status(ExecutorStatus())
        plan = decode(Plan, command.plan)
        assert plan.certificate.signature is not None
        query = CertificateQuery(plan.id, plan.certificate.signature.mac)
        station.bus.ask(station.keys.station_certificate, encode(query))
        return encode_status(ExecutorStatus())

    handle = station.bus.serve(station.keys.executor_command, answer)
    try:
        yield
    finally:
        handle.close()


# jobs and their outcomes


def test_a_task_without_demonstrations_fails_with_a_sentence(desk: Desk) -> None:
    desk.put("/tasks/unshown", {})
    job = desk.ended(desk.post("/tasks/unshown/jobs", {"kind": "learn"}))
    assert (job["state"], job["outcome"]) == ("failed", "")
    assert job["message"] == "task unshown has no usable demonstrations yet; show it a few times first"
    refused(desk.post(f"/jobs/{job['id']}/cancel"), 409, "has already failed")
    assert [j["id"] for j in desk.get("/tasks/unshown/jobs").json()] == [job["id"]]


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ('{"keeep": 1}', "there is no setting learning.keeep; known here: mode, keep"),
        ('{"keep": "two"}', "setting learning.keep is 'two'; it should be a valid integer"),
        ('{"keep": true}', "setting learning.keep is True"),
        ('{"keep": 0}', "learning.keep"),
        ('{"threshold": NaN}', "setting learning.threshold is nan; it should be a finite number"),
        ('{"threshold": []}', "setting learning.threshold"),
        ('{"mode": "other"}', "learning.mode is 'other'; it should be 'default', 'paper' or 'repaired'"),
        ('{"mode": "\\ud800"}', "settings cannot be read"),
        ('{"mode": "paper"}', "set learning.threshold in metres"),
        (f'{{"seed": 1{"0" * 400}}}', "too large"),
        ("[]", "body.settings: it should be a valid dictionary"),
    ],
)
def test_a_wrong_learning_setting_is_refused_at_once(desk: Desk, changes: str, sentence: str) -> None:
    desk.put("/tasks/unshown", {})
    before = len(desk.get("/tasks/unshown/jobs").json())
    body = f'{{"kind": "learn", "settings": {changes}}}'
    json_ = {"content-type": "application/json"}
    refused(desk.post("/tasks/unshown/jobs", json=None, content=body, headers=json_), 422, sentence)
    refused(
        desk.post("/tasks/unshown/jobs", {"kind": "dance"}), 422, "body.kind: it should be 'learn', 'recut' or 'plan'"
    )
    assert len(desk.get("/tasks/unshown/jobs").json()) == before


def test_one_single_demonstration_is_learned_and_its_outcome_is_found(desk: Desk) -> None:
    desk.import_("single", csv(120, step=0.002))
    job = desk.ended(desk.post("/tasks/single/jobs", {"kind": "learn", "settings": {"seed": 2}}))
    assert job["state"] == "succeeded", job["message"]
    run = desk.get(f"/tasks/single/runs/{job['outcome']}").json()
    (listed,) = desk.get("/tasks/single/runs").json()
    assert (listed["id"], listed["created_ns"], listed["demonstrations"]) == (run["id"], run["created_ns"], 1)
    assert listed["paths"] == [path["id"] for path in run["learned"]["paths"]]
    assert [len(c["members"]) for c in run["learned"]["clusters"]] == [1]
    assert run["learned"]["clusters"][0]["note"]
    assert run["learned"]["settings"]["seed"] == 2
    (path,) = run["learned"]["paths"]
    assert desk.get(f"/paths/{path['id']}").json() == path
    assert path["fit"]["largest"] <= path["fit"]["bound"]
    assert desk.get(f"/paths/{path['id']}/plans").json() == []

    assess_while_editing(desk, path)

    desk.put("/tasks/other", {})
    refused(desk.get(f"/tasks/other/runs/{run['id']}"), 404, "it is of task single")
    refused(desk.post("/tasks/other/jobs", {"kind": "plan", "path": path["id"]}), 422, "it is of task single")
    for accepted in (
        desk.post(f"/paths/{path['id']}/plans"),
        desk.post("/tasks/single/jobs", {"kind": "plan", "path": path["id"]}),
    ):
        ended = desk.ended(accepted)
        assert ended["state"] in ("succeeded", "failed")
        assert (ended["state"] == "succeeded") == bool(ended["outcome"]) == (not ended["message"])


def assess_while_editing(desk: Desk, path: dict[str, Any]) -> None:
    """An edited curve is looked at and nothing is stored of it."""
    place = f"/paths/{path['id']}/assessment"
    looked = desk.post(place, {"version": 1}).json()
    samples = len(looked["lengths"])
    assert all(len(looked[name]) == samples for name in ("parameters", "positions", "faults", "clearance", "singular"))
    away = path["curve"] | {"control_points": [[x + 3.0, y, z] for x, y, z in path["curve"]["control_points"]]}
    failed = desk.post(place, {"curve": away}).json()
    assert (failed["failure"]["fault"], failed["duration"]) == ("reach", None)
    assert failed["failure"]["suggestion"]["sentence"] in failed["sentence"]
    assert desk.get(f"/paths/{path['id']}").json() == path
    refused(desk.post(place, {"version": 99}), 422, "99")
    refused(desk.post(place, {"curve": away | {"weights": [-1.0]}}), 422, "weights")
    refused(desk.post("/paths/none/assessment", {}), 404, "none")
    point = away | {"control_points": [away["control_points"][0]] * len(away["control_points"])}
    refused(desk.post(place, {"curve": point}), 422, "all control points lie in one place")


@pytest.mark.parametrize("settings_", [{}, {"mode": "paper", "threshold": 0.06}])
def test_a_demonstration_shorter_than_the_window_is_learned_with_a_note(desk: Desk, settings_: dict[str, Any]) -> None:
    task = f"short-{settings_.get('mode', 'default')}"
    for _ in range(3):
        desk.import_(task, csv(12))
    job = desk.ended(desk.post(f"/tasks/{task}/jobs", {"settings": settings_}))
    assert job["state"] == "succeeded", job["message"]
    learned = desk.get(f"/tasks/{task}/runs/{job['outcome']}").json()["learned"]
    assert all(cluster["note"] for cluster in learned["clusters"])


def test_the_cut_of_a_run_is_moved_by_a_job(desk: Desk) -> None:
    for number in range(4):
        desk.import_("recut", csv(60, step=0.004, rise=0.0005 * number + 0.002 * (number > 1)))
    first = desk.ended(desk.post("/tasks/recut/jobs", {"settings": {"clusters": 2}}))
    assert first["state"] == "succeeded", first["message"]
    run = first["outcome"]
    drawn = desk.get(f"/tasks/recut/runs/{run}/dendrogram").json()
    assert [cut["clusters"] for cut in drawn["cuts"]] == [1, 2, 3, 4]
    assert [len(cut["leaf_ranges"]) for cut in drawn["cuts"]] == [1, 2, 3, 4]
    assert drawn["cuts"][0]["highest"] is None
    assert len(desk.get(f"/tasks/recut/runs/{run}/dendrogram?most=2").json()["cuts"]) == 2
    numbers = {d["id"]: d["number"] for d in desk.get("/tasks/recut/demonstrations").json()}
    halves = [[numbers[key] for key in drawn["leaves"][begin:end]] for begin, end in drawn["cuts"][1]["leaf_ranges"]]
    assert halves == [[1, 2], [3, 4]]

    for cut, ways in (({"clusters": 3}, 3), ({"threshold": drawn["cuts"][0]["height"]}, 1)):
        job = desk.ended(desk.post("/tasks/recut/jobs", {"kind": "recut", "run": run} | cut))
        assert job["state"] == "succeeded", job["message"]
        learned = desk.get(f"/tasks/recut/runs/{job['outcome']}").json()["learned"]
        assert len(learned["clusters"]) == len(learned["paths"]) == ways
        assert {path["run"] for path in learned["paths"]} == {job["outcome"]}
    assert len(desk.get("/tasks/recut/runs").json()) == 3

    for wrong, sentence in (({}, "give one of the two"), ({"clusters": 5}, "give 1 to 4"), ({"threshold": 0}, "0 m")):
        refused(desk.post("/tasks/recut/jobs", {"kind": "recut", "run": run} | wrong), 422, sentence)
    refused(desk.post("/tasks/recut/jobs", {"kind": "recut", "run": "moon"}), 422, "no run 'moon'")
    desk.put("/tasks/other", {})
    refused(desk.post("/tasks/other/jobs", {"kind": "recut", "run": run, "clusters": 1}), 422, "it is of task recut")

    desk.send("PATCH", f"{API}/demonstrations/{drawn['leaves'][0]}", json={"discarded": True})
    job = desk.ended(desk.post("/tasks/recut/jobs", {"kind": "recut", "run": run, "clusters": 1}))
    assert job["state"] == "failed"
    assert "is no longer learned from since that run" in job["message"]


def test_identical_points_are_refused_with_a_sentence(desk: Desk) -> None:
    still = "t,x,y,z\n" + "".join(f"{i * 0.02},0.4,0,0.6\n" for i in range(60))
    job = desk.ended(desk.upload("still", still))
    assert job["state"] == "failed"
    assert "the hand moves by 0 cm, limit 1 cm (recording.lift): it carries nothing" in job["message"]


# executions


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        ({"plan": "p", "overide": 0.2}, "body.overide: there is no field 'overide'; did you mean override?"),
        ({"plan": "p", "speed": 0.2, "how": 1}, "no field 'speed'; known here: plan, override, and 1 more"),
        ({"plan": "p", "x" * 500_000: 0}, f"there is no field '{'x' * 80}'"),
        ({"plan": "p"} | {f"x{n}": 0 for n in range(20_000)}, "and 19999 more"),
    ],
)
def test_a_field_that_is_not_known_moves_nothing(desk: Desk, body: dict[str, Any], sentence: str) -> None:
    before = desk.get("/executions").json()
    answer = desk.post("/executions", body)
    refused(answer, 422, sentence)
    assert len(answer.json()["errors"]) <= 20
    assert desk.get("/executions").json() == before


def test_a_field_of_another_kind_of_job_is_refused(desk: Desk) -> None:
    desk.put("/tasks/unshown", {})
    body = {"kind": "recut", "run": "r", "settings": {"seed": 1}}
    refused(desk.post("/tasks/unshown/jobs", body), 422, "there is no field of a job 'recut' 'settings'")


def test_a_field_of_another_kind_may_say_nothing() -> None:
    """Clients that are generated from the description send all fields."""
    asked = NewJob(kind="recut", run="r", clusters=2).model_dump()
    assert NewJob(**asked).model_dump() == asked


def test_without_an_executor_an_execution_is_503_and_kept_with_its_reason(desk: Desk) -> None:
    plan = planned(desk.station, "plan-good")
    assert desk.get(f"/plans/{plan}").json()["id"] == plan
    refused(desk.post("/executions", {"plan": plan}), 503, "nobody answered")
    newest = desk.get("/executions").json()[0]
    assert (newest["plan"], newest["status"]["state"]) == (plan, "faulted")
    assert "nobody answered" in newest["status"]["reason"]
    assert desk.get(f"/executions/{newest['id']}").json() == newest
    for verb in ("hold", "resume", "reverse"):
        refused(desk.post(f"/executions/{newest['id']}/{verb}"), 409, "is not running")
    for body, name in ((None, "Ada"), ({"overide": 0.2}, "A" * 1000), ([], "\x80")):  # whatever comes with it
        headers = {"Teachpath-Operator": name.encode("latin-1"), "Teachpath-Lease": "t" * 1000}
        stopped = desk.post(f"/executions/{newest['id']}/stop?soon=1", body, headers=headers)
        assert stopped.json() == newest  # a stop is always answered
    refused(desk.post(f"/executions/{newest['id']}/step", {"nodes": 1}), 409, "is not running")
    refused(desk.post(f"/executions/{newest['id']}/step", {}), 422, "one of the two")
    refused(desk.post(f"/executions/{newest['id']}/step", {"nodes": 1, "length": 0.1}), 422, "one of the two")
    refused(desk.post("/stop", headers={"Teachpath-Operator": "A" * 1000}), 503, "NOT STOPPED")
    refused(desk.post(f"/executions/{newest['id']}/override", {"override": 0.5}), 409, "is not running")
    refused(
        desk.post(f"/executions/{newest['id']}/jump"),
        404,
        "path.verb: it should be 'hold', 'resume' or 'reverse'",
    )


@pytest.mark.parametrize("field", ["tracker", "clutch"])
@pytest.mark.parametrize("name", ["a..b", "-a", "a b", "{sentence}", "x" * 65])
def test_the_name_of_a_tracker_is_refused_with_the_whole_rule(desk: Desk, field: str, name: str) -> None:
    answer = desk.post("/teleoperation", {"tracker": "glove", field: name})
    refused(answer, 422, f"body.{field}: {name_refusal('tracker', name)}")


def test_a_plan_that_was_revoked_is_not_started_again(desk: Desk) -> None:
    plan = planned(desk.station, "plan-revoked")
    with asking_executor(desk.station):
        assert desk.post("/executions", {"plan": plan}).status_code == 202
        for reason in ("the table was moved", "again"):
            assert desk.post(f"/plans/{plan}/revoke", {"reason": reason}).status_code == 204
        refused(desk.post("/executions", {"plan": plan}), 422, "was revoked: the table was moved; plan the path again")
    refused(desk.post("/plans/moon/revoke", {"reason": "x"}), 404, "no plan 'moon'")
    refused(desk.post(f"/plans/{plan}/revoke", {}), 422, "body.reason")
