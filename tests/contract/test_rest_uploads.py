"""Files over REST: sent, examined, corrected, and imported together, all or none."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from teachpath.motion.arm.kinematics import tool_pose
from tests.contract.desk import Desk, csv, refused
from tests.unit.io.readers.bags import write_bag
from tests.unit.io.readers.test_bag_joints import ANGLES, COUNT, states
from tests.waiting import wait_until

OTHER_NAMES = csv().replace("t,x,y,z", "when,a,b,c")
MAP = "t=1,x=2,y=3,z=4"


def sent(desk: Desk, content: str | bytes, name: str) -> str:
    answer = desk.post("/uploads", json=None, content=content, params={"name": name})
    assert answer.status_code == 201, answer.text
    assert (answer.json()["name"], answer.json()["size"]) == (name, len(content))
    upload: str = answer.json()["id"]
    return upload


def kept(desk: Desk, *uploads: str) -> list[str]:
    return [upload for upload in uploads if (desk.data_dir / "transfers" / upload).exists()]


def examined(desk: Desk, upload: str, task: str = "files", **choices: Any) -> dict[str, Any]:
    answer = desk.post(f"/uploads/{upload}/examination", {"task": task, "file": choices})
    assert answer.status_code == 200, answer.text
    report: dict[str, Any] = answer.json()
    return report


def test_files_are_examined_corrected_and_imported_together(desk: Desk) -> None:
    first, second = sent(desk, csv(), "first.csv"), sent(desk, OTHER_NAMES, "second.csv")
    report = examined(desk, first, name="first.csv")
    assert report["refusal"] == ""
    assert [row["verdict"] for row in report["made"]] == ["clean"]
    assert "no column for t" in examined(desk, second, name="second.csv")["refusal"]
    assert examined(desk, second, name="second.csv", columns=MAP)["made"]
    refused(desk.get("/tasks/files"), 404, "no task")  # examining stores nothing

    files = [{"upload": first, "name": "first.csv"}, {"upload": second, "name": "second.csv"}]
    job = desk.ended(desk.post("/tasks/files/imports", {"files": files}))
    assert job["state"] == "failed"
    assert "nothing was imported, 1 of 2 files cannot be used: second.csv: no column for t" in job["message"]
    refused(desk.get("/tasks/files"), 404, "no task")
    wait_until(lambda: not kept(desk, first, second), "what is not imported is removed")
    refused(desk.post("/tasks/files/imports", {"files": files}), 422, "send the file again")


def test_all_files_are_imported_in_their_order(desk: Desk) -> None:
    names = ["c.csv", "a.csv", "b.csv"]
    uploads = [sent(desk, OTHER_NAMES, name) for name in names]
    files = [
        {"upload": upload, "name": name, "columns": MAP, "grasp": 0.2, "release": 0.9}
        for upload, name in zip(uploads, names, strict=True)
    ]
    job = desk.ended(desk.post("/tasks/ordered/imports", {"files": files}))
    assert (job["state"], job["outcome"]) == ("succeeded", "1-3")
    rows = desk.get("/tasks/ordered/demonstrations").json()
    assert [row["source"] for row in rows] == names
    assert {(row["grasp"], row["release"]) for row in rows} == {(10, 46)}
    wait_until(lambda: not kept(desk, *uploads), "what was imported is removed")


def test_joint_states_are_examined_and_imported_by_the_kinematics_of_the_station_s_arm(
    desk: Desk, tmp_path: Path
) -> None:
    upload = sent(desk, write_bag(tmp_path, "mcap", states("mcap")), "led.mcap")
    report = examined(desk, upload, name="led.mcap", whole=True)
    assert np.allclose(report["positions"], tool_pose(ANGLES, desk.station.settings.arm)[:, :3, 3], atol=1e-5)
    files = [{"upload": upload, "name": "led.mcap", "whole": True}]
    assert desk.ended(desk.post("/tasks/led/imports", {"files": files}))["outcome"] == "1-1"
    (row,) = desk.get("/tasks/led/demonstrations").json()
    assert (row["calibration"]["name"], row["samples"]) == ("identity", COUNT)


def test_an_upload_is_removed_once(desk: Desk) -> None:
    upload = sent(desk, csv(), "gone.csv")
    assert desk.send("DELETE", f"/api/v1/uploads/{upload}").status_code == 204
    refused(desk.send("DELETE", f"/api/v1/uploads/{upload}"), 404, "send the file again")
    refused(desk.post(f"/uploads/{upload}/examination", {"task": "files", "file": {}}), 404, "send the file again")


@pytest.mark.parametrize(
    ("task", "choices", "sentence"),
    [
        ("a/b", {}, "cannot name a task"),
        ("files", {"units": "parsec"}, "units 'parsec' are unknown"),
        ("files", {"columns": "u=1"}, "roles:"),
        ("files", {"unit": "m"}, "there is no field 'unit'; did you mean units?"),
    ],
)
def test_what_cannot_be_used_is_named(desk: Desk, task: str, choices: dict[str, Any], sentence: str) -> None:
    upload = sent(desk, csv(), "bad.csv")
    refused(desk.post(f"/uploads/{upload}/examination", {"task": task, "file": choices}), 422, sentence)


@pytest.mark.parametrize("upload", ["..", "0" * 31, "G" * 32, "%2e%2e%2fservice.lock"])
def test_an_upload_is_no_path(desk: Desk, upload: str) -> None:
    assert desk.post(f"/uploads/{upload}/examination", {"task": "files", "file": {}}).status_code in (404, 405, 422)


def test_readers_are_listed_with_what_they_read(desk: Desk) -> None:
    names = [reader["name"] for reader in desk.get("/readers").json()]
    assert {"motive", "vicon", "csv", "npz"} <= set(names)
