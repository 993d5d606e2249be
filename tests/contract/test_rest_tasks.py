"""Tasks over REST: recording, and importing files that can and cannot be used."""

from typing import Any

import numpy as np
import pytest

from tests.contract.desk import Desk, csv, npy, refused
from tests.waiting import wait_until

# recording


def test_recording_starts_once_and_stops_with_an_account(desk: Desk) -> None:
    desk.put("/tasks/lift", {})
    begun = desk.post("/tasks/lift/recording", {"tracker": "glove"})
    assert begun.status_code == 201
    assert [r["tracker"] for r in desk.get("/tasks/lift/recording").json()] == ["glove"]
    refused(desk.post("/tasks/lift/recording", {"tracker": "glove"}), 409, "glove is already recording lift")
    refused(desk.post("/tasks/lift/recording/stop", {"tracker": "other"}), 422, "'other' is not recording lift")
    ended = desk.post("/tasks/lift/recording/stop", {"tracker": "glove"}).json()
    assert (int(ended["received"]), ended["demonstrations"]) == (0, [])
    refused(desk.post("/tasks/lift/recording/stop", {"tracker": "glove"}), 422, "running: none")
    assert desk.get("/tasks/lift/recording").json() == []


@pytest.mark.parametrize("tracker", ["", "a/b", "*", "..", "x" * 65, "a\n"])
def test_a_bad_tracker_name_is_refused(desk: Desk, tracker: str) -> None:
    desk.put("/tasks/lift", {})
    answer = desk.post("/tasks/lift/recording", {"tracker": tracker})
    refused(answer, 422, "cannot name a tracker")


# imports

SHORT_TABLE = "t,x,y,z\n" + "".join(f"{i * 0.02},{i},0,0\n" for i in range(6))


@pytest.mark.parametrize(
    ("content", "query", "sentence"),
    [
        ("", {}, "the file is empty"),
        ("t,x,y,z\n", {}, "no samples under the header"),
        ("a,b\n1,2\n", {}, "no column for t, x, y, z; its 2 columns are a, b"),
        (csv()[:-8], {}, "line 61"),
        (csv() + ",1,0,0\n", {}, "line 62: a row without a time"),
        ("t,x,y,z\n" + "".join(reversed(csv().splitlines(True)[1:])), {}, "sort by t"),
        (csv().replace("0.6\n", "1e300\n"), {}, "a position is 1e+300 m away, limit 100; say their unit with --units"),
        (csv(), {"units": "mm", "scene": "paper"}, "check units and calibration"),
        (csv() + "1e300,0,0,0\n", {}, "a time of 1e+300 s is no time"),
        ("t,x,y,z\n" + "9" * 200_000, {}, "CSV"),
        (SHORT_TABLE, {}, "under the least of 8"),
        (csv(), {"units": "parsec"}, "units 'parsec' are unknown; known: m, cm, mm, in"),
        (csv(), {"format": "xls"}, "format 'xls' is unknown; known: motive, "),
        (csv(), {"rate": "nan"}, "rate of nan Hz"),
        (csv(), {"rate": "often"}, "query.rate: it should be a valid number"),
        (csv(), {"name": "x" * 201}, "query.name"),
        (csv(), {"scene": "paper"}, "does not begin at the object of scene paper"),
        (b"", {"format": "robottasks"}, "the file is empty"),
        (b"rubbish", {"format": "robottasks"}, "not a whole file of format robottasks"),
        (b"PK\x03\x04rubbish", {"format": "robottasks"}, "not a whole file of format robottasks"),
        (npy(np.zeros((2, 30, 7)))[:-100], {"format": "robottasks"}, "not a whole .npy array"),
        (
            npy(np.zeros((2, 30, 7))).replace(b"(2, 30", b"(20000000, 30000000"),
            {"format": "robottasks"},
            "motions, limit 1000",
        ),
        (npy(np.zeros((2, 30, 3))), {"format": "robottasks"}, "the array must be floats"),
        (npy(np.zeros((0, 30, 7))), {"format": "robottasks"}, "holds no demonstrations"),
        (npy(np.zeros((2, 0, 7))), {"format": "robottasks"}, "holds no demonstrations"),
        (npy(np.full((2, 30, 7), np.inf)), {"format": "robottasks"}, "0 of its 30 samples are tracked"),
    ],
)
def test_a_file_that_cannot_be_used_is_a_sentence_and_leaves_nothing(
    desk: Desk, content: bytes | str, query: dict[str, str], sentence: str
) -> None:
    answer = desk.upload("imported-badly", content, **query)
    if answer.status_code == 202:
        job = desk.ended(answer)
        assert job["state"] == "failed"
        assert sentence in job["message"]
    else:
        refused(answer, 422, sentence)
    wait_until(lambda: list(desk.data_dir.glob("transfers/*")) == [], "the upload is removed")
    left = desk.get("/tasks/imported-badly/demonstrations")
    assert left.status_code == 404 or left.json() == []


def test_an_import_is_a_job_that_is_listed_with_its_task(desk: Desk) -> None:
    accepted = desk.upload("import-job", csv(), name="mine.csv")
    job = desk.ended(accepted)
    assert (job["kind"], job["state"], job["outcome"], job["fraction"]) == ("import", "succeeded", "1-1", 1.0)
    assert [each["id"] for each in desk.get("/tasks/import-job/jobs").json()] == [job["id"]]
    assert desk.ended(
        desk.upload("import-job", npy(np.array([turned(0.1), turned(0.2)])), format="robottasks", units="m")
    )["outcome"] == ("2-3")
    wait_until(lambda: list(desk.data_dir.glob("transfers/*")) == [], "the upload is removed")


def test_a_file_that_comes_twice_is_said(desk: Desk) -> None:
    (first,) = desk.import_("twice", csv(80), name="one.csv")
    assert first["statistics"]["notes"] == []
    (again,) = desk.import_("twice", csv(80), name="another-name.csv")
    (note,) = again["statistics"]["notes"]
    assert "the same file was imported into twice before, as 1" in note
    recording = desk.get(f"/demonstrations/{first['id']}/recording").content
    (copy,) = desk.import_("twice", recording, name="copy.mcap")
    assert "was imported into twice before, as 1:" in copy["statistics"]["notes"][-1]
    (other,) = desk.import_("once-more", csv(80), name="one.csv")
    assert other["statistics"]["notes"] == []
    for shown in (first, again):
        desk.send("PATCH", f"/api/v1/demonstrations/{shown['id']}", json={"discarded": True})
    (alone,) = desk.import_("twice", csv(80))
    assert alone["statistics"]["notes"] == []

    upload = desk.post("/uploads", json=None, content=csv(80), params={"name": "one.csv"}).json()
    reports = [
        desk.post(f"/uploads/{upload['id']}/examination", {"task": task, "file": {"name": "one.csv"}}).json()
        for task in ("twice", "never-seen")
    ]
    said = [report["imported_before"] for report in reports]
    assert (said[0].startswith("the same file was imported into twice before, as 4:"), said[1]) == (True, "")


def turned(reach: float) -> Any:
    values = np.zeros((40, 7))
    values[:, 3], values[:, 0] = 1.0, np.linspace(0.4, 0.4 + reach, 40)
    return values


def test_a_file_is_imported_in_its_units_and_read_back(desk: Desk) -> None:
    (made,) = desk.import_("inches", csv(), units="in", name="mine.csv")
    assert (made["source"], made["samples"], made["verdict"], made["number"]) == ("mine.csv", 60, "clean", 1)
    way = desk.get(f"/demonstrations/{made['id']}/trajectory").json()
    assert way["positions"][-1][0] - way["positions"][0][0] == pytest.approx(0.59 * 0.0254)
    assert desk.get(f"/demonstrations/{made['id']}").json() == made
    recording = desk.get(f"/demonstrations/{made['id']}/recording")
    assert recording.content.startswith(b"\x89MCAP0\r\n")
    turned = np.zeros((3, 40, 7))
    turned[..., 3], turned[..., 0] = 1.0, np.linspace(0.4, 0.6, 40)
    assert len(desk.import_("array", npy(turned), format="robottasks", units="m")) == 3


def test_an_empty_scene_of_tasks_shows_lists(desk: Desk) -> None:
    desk.put("/tasks/bare", {})
    for resource in ("demonstrations", "jobs", "runs", "recording"):
        assert desk.get(f"/tasks/bare/{resource}").json() == []
    health = desk.get("/health").json()
    assert health["executor"] is None
    # Other tests add theirs behind them.
    assert [s["name"] for s in desk.get("/scenes").json()][:2] == ["paper", "empty"]
    assert [c["calibration"]["name"] for c in desk.get("/calibrations").json()][:2] == ["identity", "robottasks"]


# control of a recording, and what is said of demonstrations


def test_an_armed_recording_pauses_resumes_and_says_its_state(desk: Desk) -> None:
    desk.put("/tasks/armed", {})
    begun = desk.post("/tasks/armed/recording", {"tracker": "pedal", "armed": True, "rate": 50})
    assert (begun.json()["state"], begun.json()["declared_rate"]) == ("paused", 50.0)
    refused(desk.post("/tasks/armed/recording/resume", {"tracker": "other"}), 422, "'other' is not recording armed")
    for verb, state in (("resume", "recording"), ("pause", "paused"), ("pause", "paused")):
        assert desk.post(f"/tasks/armed/recording/{verb}", {"tracker": "pedal"}).json()["state"] == state
    assert desk.post("/tasks/armed/recording/stop", {"tracker": "pedal"}).json()["state"] == ""
    refused(desk.post("/tasks/armed/recording", {"tracker": "pedal", "rate": -1}), 422, "body.rate")
    refused(desk.post("/tasks/armed/recording/pause", {"tracker": "pedal"}), 422, "running: none")


def test_demonstrations_are_discarded_restored_marked_and_trimmed(desk: Desk) -> None:
    made = [desk.import_("curated", csv())[0] for _ in range(2)]
    refused(desk.post("/tasks/curated/recording/restore"), 404, "no discarded demonstration")
    gone = desk.post("/tasks/curated/recording/discard").json()
    assert (gone["id"], gone["discarded_ns"] > 0) == (made[1]["id"], True)
    assert desk.post("/tasks/curated/recording/restore").json() == made[1]

    here = f"/api/v1/demonstrations/{made[0]['id']}"
    marked = desk.send("PATCH", here, json={"mark": "bad"}).json()
    assert marked == made[0] | {"mark": "bad"}
    trimmed = desk.send("PATCH", here, json={"trim": [10, 40]}).json()
    assert (trimmed["trim"], trimmed["grasp"], trimmed["release"]) == ([10, 40], 0, 60)
    assert len(desk.get(f"/demonstrations/{made[0]['id']}/trajectory").json()["times"]) == 30
    assert desk.send("PATCH", here, json={"trim": [0, 0], "mark": ""}).json() == made[0]
    assert desk.send("PATCH", here, json={}).json() == made[0]
    refused(desk.send("PATCH", here, json={"trim": [50, 70]}), 422, "no transport phase of a recording with 60 samples")
    refused(desk.send("PATCH", here, json={"mark": "ugly"}), 422, "body.mark")
    refused(desk.send("PATCH", "/api/v1/demonstrations/moon", json={"mark": "bad"}), 404, "demonstration 'moon'")
    for verb in ("discard", "restore"):
        refused(desk.post(f"/tasks/moon/recording/{verb}"), 404, "task 'moon'")


def test_trackers_that_are_there_are_in_the_health(desk: Desk) -> None:
    token = desk.station.bus.announce(desk.station.keys.alive("tracker", "glove-9"))
    seen = lambda: [t["name"] for t in desk.get("/health").json()["trackers"]]  # noqa: E731
    wait_until(lambda: "glove-9" in seen(), "the tracker is there")
    token.close()
    wait_until(lambda: "glove-9" not in seen(), "the tracker has gone")


def test_what_is_not_usable_is_not_learned_from(desk: Desk) -> None:
    (only,) = desk.import_("unusable", csv())
    desk.send("PATCH", f"/api/v1/demonstrations/{only['id']}", json={"mark": "bad"})
    job = desk.ended(desk.post("/tasks/unusable/jobs", {"kind": "learn"}))
    assert (job["state"], "no usable demonstrations" in job["message"]) == ("failed", True)


def test_a_trajectory_is_thinned_to_what_is_asked_for(desk: Desk) -> None:
    (made,) = desk.import_("thinned", csv(120, step=0.002))
    address = f"/demonstrations/{made['id']}/trajectory"
    whole, few = desk.get(address).json(), desk.get(address, params={"most": 10}).json()
    assert len(few["times"]) == len(few["positions"]) == 10
    assert (few["times"][0], few["times"][-1]) == (whole["times"][0], whole["times"][-1])
    assert all(position in whole["positions"] for position in few["positions"])
    refused(desk.get(address, params={"most": 1}), 422, "query.most")
    short = desk.get(address, params={"decimals": 4}).json()["positions"]
    assert np.abs(np.subtract(short, whole["positions"])).max() < 0.5001e-4
    assert short == [[round(value, 4) for value in position] for position in short] != whole["positions"]
    refused(desk.get(address, params={"decimals": 3}), 422, "query.decimals")
