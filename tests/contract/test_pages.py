"""Lists a page at a time: every entry once and in order, whatever is added meanwhile; a bad cursor is refused."""

import base64
import json
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from teachpath.errors import UnusableInput
from teachpath.io.store.pages import Page, PageRequest
from teachpath.io.store.settings import StoreSettings
from teachpath.io.store.store import Store
from teachpath.records import Job
from teachpath_client import Station
from tests.contract.desk import Desk, refused
from tests.contract.rows import a_job, demonstration

LISTS = ["tasks", "demonstrations", "runs", "jobs", "plans", "versions", "executions", "journal"]


def cursor(*document: object) -> str:
    return base64.urlsafe_b64encode(json.dumps(document).encode()).decode().rstrip("=")


def walked(read: Callable[[PageRequest], Page[Job]], limit: int, between: Callable[[], object]) -> Iterator[Job]:
    """Yield what is on the pages of a list, one after the other."""
    page = read(PageRequest(limit))
    while True:
        assert len(page.entries) <= limit
        yield from page.entries
        if not page.next:
            return
        between()
        page = read(PageRequest(limit, page.next))


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    created=st.lists(st.integers(0, 3), min_size=1, max_size=12),
    added=st.lists(st.integers(0, 5), max_size=4),
    limit=st.integers(1, 5),
)
def test_pages_hold_every_entry_once_and_in_order_whatever_is_added(
    tmp_path: Path, created: list[int], added: list[int], limit: int
) -> None:
    store = Store(StoreSettings(str(tmp_path), "sqlite://"))
    try:
        present = [a_job(f"learn-{i}", created_ns=at) for i, at in enumerate(created)]
        later = iter([a_job(f"later-{i}", created_ns=at) for i, at in enumerate(added)])
        for job in present:
            store.add_job(job)

        def add() -> None:
            for job in later:
                store.add_job(job)
                return

        seen = list(walked(lambda wanted: store.lists.jobs("t", wanted), limit, add))
        order = sorted(seen, key=lambda job: (job.created_ns, job.id), reverse=True)
        assert seen == order
        assert len({job.id for job in seen}) == len(seen)
        assert {job.id for job in present} <= {job.id for job in seen}
    finally:
        store.close()


def test_demonstrations_are_walked_over_rest_and_by_the_client(desk: Desk, port: int) -> None:
    store = desk.station.store
    store.ensure_task("paged", scene="paper", calibration="identity")
    made = [store.add_demonstration(demonstration(f"paged-{i}", task="paged")).id for i in range(7)]
    first = desk.get("/tasks/paged/demonstrations?limit=3")
    assert [d["id"] for d in first.json()] == made[:3]
    second = desk.send("GET", first.links["next"]["url"])
    assert [d["id"] for d in second.json()] == made[3:6]
    last = desk.send("GET", second.links["next"]["url"])
    assert [d["id"] for d in last.json()] == made[6:]
    assert "next" not in last.links
    with Station(f"http://127.0.0.1:{port}") as station:
        assert [d.id for d in station.demonstrations("paged")] == made
        pages = list(station.pages("/tasks/paged/demonstrations", limit=4))
        assert [d["id"] for page in pages for d in page] == made[:4]


@pytest.mark.parametrize("name", LISTS)
def test_every_list_refuses_a_cursor_that_is_none_of_its_own(desk: Desk, name: str) -> None:
    lists, of = (
        desk.station.store.lists,
        {"demonstrations": "t", "runs": "t", "jobs": "t", "plans": "p", "versions": "p"},
    )
    for bad in (
        "x",
        "!",
        "====",
        "é",
        cursor(),
        cursor("other", 1),
        cursor(name),
        cursor(name, 2**63, "a"),
        cursor(name, []),
    ):
        with pytest.raises(UnusableInput, match="is no cursor of this list; take the one in the header Link"):
            getattr(lists, name)(*filter(None, [of.get(name)]), wanted=PageRequest(after=bad))


def test_a_bad_page_is_refused_with_the_way_out(desk: Desk) -> None:
    desk.put("/tasks/paged-badly", {})
    refused(desk.get("/tasks?after=moon"), 422, "after=moon is no cursor of this list; take the one in the header Link")
    refused(desk.get("/tasks?limit=0"), 422, "query.limit")
    refused(desk.get("/tasks?limit=501"), 422, "less than or equal to 500")
    refused(desk.get(f"/tasks?after={'x' * 301}"), 422, "query.after")
    refused(desk.get("/tasks?aftre=x"), 422, "did you mean after?")
