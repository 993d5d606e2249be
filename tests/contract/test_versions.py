"""Versions of a path and operations on curves over REST: nothing is saved over anything, and no edit is lost."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from teachpath.errors import Outdated
from teachpath.io.store.versions import Edit
from teachpath.nurbs import Curve
from tests.contract.desk import Desk, refused
from tests.contract.rows import a_job, learned

CURVE = {
    "degree": 3,
    "knots": [0, 0, 0, 0, 0.5, 1, 1, 1, 1],
    "control_points": [[0.4, -0.3, 0.4], [0.4, -0.2, 0.7], [0.6, 0.0, 0.7], [0.6, 0.2, 0.7], [0.4, 0.3, 0.4]],
    "weights": [1, 1, 2, 1, 1],
}


def moved(by: float) -> dict[str, Any]:
    points = [[x, y, z + by] for x, y, z in CURVE["control_points"]]  # type: ignore[union-attr]
    return CURVE | {"control_points": points}


@pytest.fixture
def path(desk: Desk, request: pytest.FixtureRequest) -> str:
    """A learned path of the test's own."""
    key = f"learn-{abs(hash(request.node.name)):x}"
    desk.put("/tasks/t", {})
    desk.station.store.add_job(a_job(key))
    return f"{desk.station.store.finish_learning(key, learned())}-1"


def save(desk: Desk, path: str, base: int, curve: dict[str, Any], **more: Any) -> Any:
    return desk.post(f"/paths/{path}/versions", {"base": base, "curve": curve, **more})


def test_what_was_learned_is_the_first_version(desk: Desk, path: str) -> None:
    (first,) = desk.get(f"/paths/{path}/versions").json()
    assert (first["number"], first["parent"], first["branch"], first["name"]) == (1, None, "main", "learned")
    assert desk.get(f"/paths/{path}/versions/1").json() == {
        "version": first,
        "path": desk.get(f"/paths/{path}").json(),
    }


def test_what_a_path_was_learned_from_may_be_gone(desk: Desk, path: str) -> None:
    key = f"{path.removesuffix('-1')}-lacking".replace("run-", "learn-", 1)
    desk.station.store.add_job(a_job(key))
    lacking = desk.station.store.finish_learning(key, replace(learned(), clusters=learned().clusters[:1]))
    for each in (path, f"{path[:-1]}2", f"{lacking}-2"):
        refused(
            desk.get(f"/paths/{each}/versions/1/adaptation-model"), 409, f"path {each} was learned from have changed"
        )


def test_a_saved_version_is_the_newest_and_the_others_stay(desk: Desk, path: str) -> None:
    before = desk.get(f"/paths/{path}/versions/1").json()
    answer = save(desk, path, 1, CURVE, name=" higher ", author="Ada", note="over the\nbox")
    assert answer.status_code == 201
    assert answer.headers["location"] == f"/api/v1/paths/{path}/versions/2"
    saved = answer.json()
    assert (saved["number"], saved["parent"], saved["branch"]) == (2, 1, "main")
    assert (saved["name"], saved["author"], saved["note"]) == ("higher", "Ada", "over the\nbox")
    newest = desk.get(f"/paths/{path}").json()
    assert newest["version"] == 2
    assert newest["curve"] == CURVE
    assert newest["fit"] is None
    assert desk.get(f"/paths/{path}/versions/1").json() == before


def test_the_second_of_two_gets_the_newer_version_and_loses_nothing(desk: Desk, path: str) -> None:
    first = save(desk, path, 1, moved(0.01), author="Ada", name="higher").json()
    answer = save(desk, path, 1, moved(0.02), author="Bob")
    refused(
        answer, 409, "version 2 (higher) was saved on branch main meanwhile by Ada, and your edit began at version 1"
    )
    assert answer.json()["error"] == "Outdated"
    assert answer.json()["newer"] == first
    assert len(desk.get(f"/paths/{path}/versions").json()) == 2
    aside = save(desk, path, 1, moved(0.02), author="Bob", branch="bob").json()
    assert (aside["number"], aside["parent"], aside["branch"]) == (3, 1, "bob")
    assert desk.get(f"/paths/{path}").json()["version"] == 2  # the main branch
    refused(save(desk, path, 2, moved(0.03), branch="bob"), 409, "on branch bob")
    assert save(desk, path, 3, moved(0.03)).json()["branch"] == "bob"
    assert save(desk, path, 2, moved(0.03)).json()["branch"] == "main"


def test_of_many_who_save_at_once_one_wins_and_the_others_are_told(desk: Desk, path: str) -> None:
    store = desk.station.store
    curve = Curve(3, np.array(CURVE["knots"]), np.array(CURVE["control_points"]), np.array(CURVE["weights"]))

    def try_(who: int) -> object:
        try:
            return store.versions.save(path, curve, Edit(base=1, author=str(who)))
        except Outdated as error:
            return error.newer

    with ThreadPoolExecutor(8) as threads:
        told = list(threads.map(try_, range(8)))
    first, second = store.lists.versions(path).entries
    assert (first.number, second.number) == (1, 2)
    assert told == [second] * 8


def test_an_edit_of_nothing_is_not_saved_but_begins_a_branch(desk: Desk, path: str) -> None:
    save(desk, path, 1, CURVE)
    refused(save(desk, path, 2, CURVE), 422, "this is the curve of version 2; edit it, or name another branch")
    assert save(desk, path, 2, CURVE, branch="trial").json()["parent"] == 2


@pytest.mark.parametrize(
    ("body", "sentence"),
    [
        ({}, "body.base"),
        ({"base": 1, "curve": {}}, "body.curve.degree"),
        ({"base": 1, "curve": CURVE | {"weights": [1, 1, -1, 1, 1]}}, "weights are positive"),
        ({"base": 1, "curve": CURVE | {"weights": [1, 1, 1]}}, "5 control points need 5 weights, got 3"),
        ({"base": 1, "curve": CURVE | {"knots": [0, 0, 0, 0, 1, 1, 1, 1]}}, "need 9 knots, got 8"),
        ({"base": 1, "curve": CURVE | {"control_points": [[1, 2]] * 5}}, "body.curve.control_points.0"),
        ({"base": 1, "curve": CURVE | {"control_points": [[50, 0, 0]] * 5}}, "50 m away, limit 10; use metres"),
        ({"base": 1, "curve": CURVE | {"control_points": []}}, "a NURBS"),
        ({"base": 1, "curve": CURVE, "branch": "a/b"}, "body.branch"),
        ({"base": 1, "curve": CURVE, "branch": "x" * 65}, "body.branch"),
        ({"base": 1, "curve": CURVE, "name": "two\nlines"}, "body.name"),
        ({"base": 1, "curve": CURVE, "note": "x" * 2001}, "body.note"),
        ({"base": 1, "curve": CURVE, "author": 3}, "body.author: it should be a valid string"),
    ],
    ids=range(13),
)
def test_a_version_that_cannot_be_used_is_refused_and_not_saved(
    desk: Desk, path: str, body: dict[str, Any], sentence: str
) -> None:
    refused(desk.post(f"/paths/{path}/versions", body), 422, sentence)
    assert len(desk.get(f"/paths/{path}/versions").json()) == 1


def test_a_curve_with_a_number_that_is_none_is_refused(desk: Desk, path: str) -> None:
    text = '{"degree":1,"knots":[0,0,1,1],"control_points":[[NaN,0,0],[1,0,0]],"weights":[1,1]}'
    json_ = {"content-type": "application/json"}
    for resource, body in (
        (f"/paths/{path}/versions", f'{{"base":1,"curve":{text}}}'),
        ("/curves/elevate", f'{{"curve":{text}}}'),
        ("/curves/evaluate", f'{{"curve":{text.replace("NaN", "Infinity")},"u":[0]}}'),
    ):
        refused(desk.post(resource, json=None, content=body, headers=json_), 422, "not finite")


def test_what_has_no_such_version_says_which_there_are(desk: Desk, path: str) -> None:
    has = f"there is no version 7 of path {path!r}; it has 1 to 1"
    refused(desk.get(f"/paths/{path}/versions/7"), 404, has)
    refused(desk.get(f"/paths/{path}/versions/1/difference/7"), 404, has)
    refused(save(desk, path, 7, CURVE), 422, has)
    refused(desk.post(f"/paths/{path}/plans", {"version": 7}), 422, has)
    refused(desk.get(f"/paths/{path}/versions/{10**30}"), 404, "it has 1 to 1")
    for resource in ("/paths/moon/versions", "/paths/moon/versions/1", "/paths/moon/versions/1/difference/2"):
        refused(desk.get(resource), 404, "there is no path 'moon'")
    refused(save(desk, "moon", 1, CURVE), 404, "there is no path 'moon'")


def test_two_versions_are_compared(desk: Desk, path: str) -> None:
    save(desk, path, 1, CURVE)
    points = [list(p) for p in CURVE["control_points"]]  # type: ignore[union-attr]
    points[2][2] += 0.05
    save(desk, path, 2, CURVE | {"control_points": points})
    found = desk.get(f"/paths/{path}/versions/2/difference/3").json()
    assert 0 < found["mean"] < found["largest"] < 0.05
    (only,) = found["moved"]
    assert (only["number"], only["weights"]) == (3, [2.0, 2.0])
    assert only["distance"] == pytest.approx(0.05)
    assert desk.get(f"/paths/{path}/versions/3/difference/3").json()["largest"] == 0.0


def test_a_plan_is_of_the_version_that_was_asked_for(desk: Desk, path: str) -> None:
    save(desk, path, 1, CURVE)
    save(desk, path, 1, moved(0.05), branch="aside")
    wanted = [(None, 2), ({}, 2), ({"version": 1}, 1), ({"version": 3}, 3)]
    for body, version in wanted:
        key = {"Idempotency-Key": f"plan {version}"}
        first, again = (desk.post(f"/paths/{path}/plans", body, headers=key).json() for _ in range(2))
        assert first["request"] == {"path": path, "version": version}
        assert again["id"] == first["id"]
    job = desk.post("/tasks/t/jobs", {"kind": "plan", "path": path, "version": 3}).json()
    assert job["request"] == {"path": path, "version": 3}


# operations on curves


def test_operations_leave_the_shape_and_say_how_exactly(desk: Desk) -> None:
    u = np.linspace(0, 1, 101).tolist()
    before = np.array(desk.post("/curves/evaluate", {"curve": CURVE, "u": u}).json())
    for operation, more in (
        ("insert-knot", {"u": 0.3}),
        ("elevate", {}),
        ("remove-knot", {"u": 0.5, "tolerance": 0.1}),
    ):
        answer = desk.post(f"/curves/{operation}", {"curve": CURVE, **more}).json()
        after = np.array(desk.post("/curves/evaluate", {"curve": answer["curve"], "u": u}).json())
        moved_by = np.linalg.norm(after - before, axis=1).max()
        assert moved_by <= answer["deviation"] + 1e-12
        assert answer["deviation"] <= (0.1 if operation == "remove-knot" else 1e-9)
    assert desk.post("/curves/evaluate", {"curve": CURVE, "u": []}).json() == []


@pytest.mark.parametrize(
    ("operation", "more", "sentence"),
    [
        ("insert-knot", {}, "insert-knot needs the parameter u of the knot"),
        ("insert-knot", {"u": 1.5}, "u = 1.5 is outside the curve"),
        ("remove-knot", {"u": 0.3}, "u = 0.3 is no inner knot of the curve; it has 0.5"),
        ("remove-knot", {"u": 0.5}, "the curve moves by"),
        ("remove-knot", {"u": 0.5, "tolerance": 5}, "a tolerance of 5 m is outside 0 to 0.1"),
        ("evaluate", {"u": [2.0]}, "body.u.0"),
        ("evaluate", {"u": [0.5] * 2002}, "body.u"),
    ],
)
def test_an_operation_that_is_not_possible_says_why(
    desk: Desk, operation: str, more: dict[str, Any], sentence: str
) -> None:
    refused(desk.post(f"/curves/{operation}", {"curve": CURVE, **more}), 422, sentence)
