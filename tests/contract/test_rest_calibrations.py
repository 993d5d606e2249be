"""Calibrations over REST: measured, listed, refused; and what becomes of demonstrations under a former one."""

from typing import Any

import pytest

from tests.contract.desk import Desk, csv, refused

SQUARE = [[0.4, -0.3, 0.5], [0.7, -0.3, 0.5], [0.7, 0.3, 0.5]]


def points(shift: float) -> dict[str, Any]:
    """Return what a tracker sees whose frame lies `shift` along x."""
    return {"points": [{"tracker": [x - shift, y, z], "world": [x, y, z]} for x, y, z in SQUARE]}


def test_a_calibration_is_measured_listed_and_used(desk: Desk) -> None:
    looked = desk.put("/calibrations/lab", points(0.1) | {"keep": False}).json()
    assert (looked["version"], looked["rms"]) == (0, pytest.approx(0.0, abs=1e-9))
    refused(desk.get("/calibrations/lab"), 404, "there is no calibration 'lab'; known: identity, robottasks")
    for version in (1, 2):
        made = desk.put("/calibrations/lab", points(0.1 * version) | {"source": "fastrak"}).json()
        assert (made["version"], made["source"], len(made["points"])) == (version, "fastrak", 3)
    assert [m["version"] for m in desk.get("/calibrations/lab").json()] == [2, 1]
    assert "lab" in [m["calibration"]["name"] for m in desk.get("/calibrations").json()]
    (demonstration,) = desk.import_("calibrated", csv(), calibration="lab")
    assert demonstration["calibration"] == made["calibration"]


@pytest.mark.parametrize(
    ("name", "body", "status", "sentence"),
    [
        ("bad", {"points": []}, 422, "0 points do not fix a frame"),
        ("bad", {"points": [{"tracker": [0, 0, 0], "world": [i, 0, 0]} for i in range(4)]}, 422, "on one line"),
        ("bad", {"points": [{"tracker": [0, 0], "world": [0, 0, 0]}]}, 422, "body.points.0.tracker"),
        ("bad", {"points": [{"tracker": [0, 0, "x"], "world": [0, 0, 0]}]}, 422, "body.points.0.tracker.2"),
        ("bad", {"points": [{"tracker": [0, 0, 1e9], "world": [0, 0, 0]}] * 3}, 422, "on one line"),
        ("identity", points(0.1), 409, "is in the settings"),
        ("a b", points(0.1), 422, "cannot name a calibration"),
        ("x" * 65, points(0.1), 422, "cannot name a calibration"),
    ],
)
def test_a_calibration_that_cannot_be_is_a_sentence_and_leaves_nothing(
    desk: Desk, name: str, body: dict[str, Any], status: int, sentence: str
) -> None:
    known = desk.get("/calibrations").json()
    refused(desk.put(f"/calibrations/{name}", body), status, sentence)
    assert desk.get("/calibrations").json() == known


def test_learning_refuses_a_former_version_until_it_is_converted_or_wanted(desk: Desk) -> None:
    desk.put("/calibrations/bench", points(0.0))
    made = [desk.import_("moved", csv(step=0.01 + 0.0001 * i), calibration="bench")[0] for i in range(3)]
    desk.put("/calibrations/bench", points(0.2))
    job = desk.ended(desk.post("/tasks/moved/jobs", {"kind": "learn"}))
    assert job["state"] == "failed"
    assert "demonstrations 1, 2, 3 were recorded under another version of the calibration bench" in job["message"]
    learned = desk.ended(desk.post("/tasks/moved/jobs", {"kind": "learn", "calibrations": "recorded"}))
    assert learned["state"] == "succeeded", learned["message"]

    cut = {"kind": "recut", "run": learned["outcome"], "clusters": 1}
    again = desk.ended(desk.post("/tasks/moved/jobs", cut))
    assert again["state"] == "failed"
    assert "take them as they were recorded: teachpath recut --as-recorded moved" in again["message"]
    again = desk.ended(desk.post("/tasks/moved/jobs", cut | {"calibrations": "recorded"}))
    assert again["state"] == "succeeded", again["message"]

    changed = desk.post("/tasks/moved/calibration", {}).json()
    assert [c["calibration"]["offset"][0] for c in changed] == pytest.approx([0.2] * 3)
    assert desk.ended(desk.post("/tasks/moved/jobs", {"kind": "learn"}))["state"] == "succeeded"
    back = desk.post("/tasks/moved/calibration", {"calibration": "bench@1"}).json()
    assert back == made
    refused(desk.post("/tasks/moved/calibration", {"calibration": "bench@9"}), 422, "no version 9")
    refused(desk.post("/tasks/moon/calibration", {}), 404, "task 'moon'")
