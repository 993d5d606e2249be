"""An order that comes again with its key begins nothing: whoever heard no answer may ask again."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from teachpath.errors import Conflict
from teachpath.jobs.idempotency import job_id
from tests.contract.desk import Desk, csv, refused

KEY = {"Idempotency-Key": "order 1"}


def test_a_job_is_begun_once(desk: Desk) -> None:
    desk.put("/tasks/once", {})
    order = {"kind": "learn"}
    first = desk.post("/tasks/once/jobs", order, headers=KEY)
    again = desk.post("/tasks/once/jobs", order, headers=KEY)
    assert again.json()["id"] == first.json()["id"]
    assert again.headers["Location"] == first.headers["Location"]
    desk.ended(first)
    assert desk.post("/tasks/once/jobs", order, headers=KEY).json()["state"] == "failed"  # what has become of it
    assert len(desk.get("/tasks/once/jobs").json()) == 1
    desk.ended(desk.post("/tasks/once/jobs", order, headers={"Idempotency-Key": "order 2"}))
    desk.ended(desk.post("/tasks/once/jobs", order))
    desk.ended(desk.post("/tasks/once/jobs", order))
    assert len(desk.get("/tasks/once/jobs").json()) == 4


def test_a_key_of_another_order_is_refused(desk: Desk) -> None:
    desk.put("/tasks/other", {})
    desk.ended(desk.post("/tasks/other/jobs", {"kind": "learn"}, headers=KEY))
    other = {"kind": "learn", "settings": {"seed": 7}}
    refused(desk.post("/tasks/other/jobs", other, headers=KEY), 409, "send a new key with each order")
    refused(desk.post("/tasks/other/jobs", {"kind": "learn"}, headers={"Idempotency-Key": "x" * 101}), 422, "Key")


def test_a_file_is_imported_once(desk: Desk) -> None:
    place = "/tasks/file-once/demonstrations"
    first = desk.post(place, json=None, content=csv(), headers=KEY)
    desk.ended(first)
    again = desk.post(place, json=None, content=csv(), headers=KEY)
    assert again.json()["id"] == first.json()["id"]
    assert len(desk.get(place).json()) == 1
    refused(desk.post(f"{place}?whole=true", json=None, content=csv(), headers=KEY), 409, "send a new key")


def test_orders_that_come_at_the_same_time_are_one(desk: Desk) -> None:
    desk.put("/tasks/race", {})
    jobs = desk.station.jobs

    def order(_: int) -> str:
        return jobs.submit("race", "learn", {"settings": {}}, "me", idempotency_key="k").id

    with ThreadPoolExecutor(8) as pool:
        assert set(pool.map(order, range(24))) == {job_id("race", "learn", "me", "k")}
    assert len(desk.station.store.jobs(task="race")) == 1
    with pytest.raises(Conflict, match="another order"):
        jobs.submit("race", "learn", {"settings": {"seed": 2}}, "me", idempotency_key="k")


def test_another_version_of_a_path_is_another_order(desk: Desk) -> None:
    desk.put("/tasks/versions-apart", {})
    jobs = desk.station.jobs
    jobs.submit("versions-apart", "plan", {"path": "none", "version": 1}, "me", idempotency_key="k")
    with pytest.raises(Conflict, match="another order"):
        jobs.submit("versions-apart", "plan", {"path": "none", "version": 2}, "me", idempotency_key="k")


def test_ids_differ_by_all_that_tells_orders_apart() -> None:
    same = ("task", "learn", "me", "key")
    others = {job_id(*(f"{word}x" if i == k else word for i, word in enumerate(same))) for k in range(4)}
    assert len({job_id(*same), *others}) == 5
    assert job_id(*same) == job_id(*same)
    assert job_id("task", "learn", "me", "") != job_id("task", "learn", "me", "")
