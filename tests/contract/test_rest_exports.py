"""Exports over REST: what is sent is what import takes."""

import io
import zipfile

import pytest

from tests.contract.desk import Desk, csv, refused

SIDE_FILES = {"archive": {"task.json", "SHA256SUMS"}}  # the files of the demonstrations


@pytest.mark.parametrize("kind", ["csv", "mcap", "trajectory"])
def test_a_demonstration_is_taken_away_and_brought_back(desk: Desk, kind: str) -> None:
    (made,) = desk.import_("taken", csv())
    file = desk.get(f"/demonstrations/{made['id']}/export", params={"format": kind})
    assert file.headers["content-disposition"].startswith(f'attachment; filename="taken-{made["number"]:03d}')
    (again,) = desk.import_("taken", file.content, format="mcap" if kind == "mcap" else "csv")
    assert (again["samples"], again["verdict"]) == (made["samples"], made["verdict"])
    ways = [desk.get(f"/demonstrations/{d['id']}/trajectory").json() for d in (made, again)]
    assert ways[0]["positions"] == ways[1]["positions"]


@pytest.mark.parametrize("kind", ["csv", "mcap", "trajectory", "lerobot", "lerobot-2.1", "archive"])
def test_a_task_is_taken_away_as_a_zip(desk: Desk, kind: str) -> None:
    task = f"zipped-{kind}"
    made = [desk.import_(task, csv())[0] for _ in range(2)]
    desk.send("PATCH", f"/api/v1/demonstrations/{made[0]['id']}", json={"mark": "bad"})
    for all_, count in ((False, 1), (True, 2)):
        archive = zipfile.ZipFile(io.BytesIO(desk.get(f"/tasks/{task}/export?format={kind}&all={all_}").content))
        assert archive.testzip() is None
        names = archive.namelist()
        if kind in ("lerobot", "lerobot-2.1"):
            assert f"{task}/meta/info.json" in names
        else:
            assert len(names) - len(SIDE_FILES.get(kind, ())) == count
            assert {name.partition("/")[2] for name in names} >= SIDE_FILES.get(kind, set())


def test_what_is_not_there_or_not_known_is_said(desk: Desk) -> None:
    refused(desk.get("/tasks/moon/export"), 404, "task 'moon'")
    refused(desk.get("/demonstrations/moon/export"), 404, "demonstration 'moon'")
    desk.put("/tasks/bare-export", {})
    refused(desk.get("/tasks/bare-export/export"), 404, "no usable demonstrations to export, of 0 in all")
    refused(desk.get("/tasks/bare-export/export?format=xls"), 422, "query.format")
