import numpy as np
import pytest

from teachpath.errors import UnusableInput
from teachpath.io import documents
from teachpath.nurbs import Curve
from teachpath.records import Certificate, Extreme, Fit, LearnedPath, Plan, Scene, Shape


def a_path() -> LearnedPath:
    curve = Curve(1, np.array([0.0, 0, 1, 1]), np.array([[0.0, 0, 0], [0.1, 1 / 3, 2]]), np.ones(2))
    return LearnedPath("p", "r", 0, 1, curve, Fit(0.005, 0.004, 0.001, 0.01), "note")


def a_plan() -> Plan:
    nowhere = Extreme(0.5, "joint 1 at s = 0.000 m", 0.0)
    certificate = Certificate("00", "righty up flip", *[nowhere] * 7)
    box = Shape("box", "box", (0.1, 0.1, 0.1), (0.0, 0.0, 0.0))
    joints = np.arange(12.0).reshape(2, 6) / 7
    return Plan("id", "p", 1, Scene("s", (box,), box), np.array([0, 1.0]), joints, np.array([0.1, 0.7]),
                joints[[0, 1, 0]], joints[0], joints[1], 2.0, certificate)  # fmt: skip


def test_a_path_survives_json_to_the_last_bit() -> None:
    path = a_path()
    again = documents.decode(LearnedPath, documents.encode(path))
    assert again.curve.control_points.tobytes() == path.curve.control_points.tobytes()
    assert again.fit == path.fit
    assert again.note == path.note


def test_a_plan_survives_json_to_the_last_bit() -> None:
    plan = a_plan()
    again = documents.decode(Plan, documents.encode(plan))
    assert again.joints.tobytes() == plan.joints.tobytes()
    assert again.scene == plan.scene
    assert documents.encode(again) == documents.encode(plan)


def test_a_scene_that_was_stored_without_floor_and_zones_has_the_defaults() -> None:
    document = documents.to_document(a_plan().scene)
    for field in ("floor", "keep_in", "keep_out"):
        del document[field]
    assert documents.from_document(Scene, document) == a_plan().scene


@pytest.mark.parametrize("payload", [b"", b"{", b"[]", b"null", b"\xff", b'{"id": 1}'])
def test_what_is_no_document_is_a_sentence(payload: bytes) -> None:
    with pytest.raises(UnusableInput, match=r"not a (Plan|.* in JSON)|not a Plan"):
        documents.decode(Plan, payload)


@pytest.mark.parametrize("number", ["NaN", "-Infinity", "1e999", "-1e0999", "1E+400"])
def test_a_number_that_is_not_finite_is_refused_wherever_it_stands(number: str) -> None:
    payload = documents.encode(a_plan()).replace(b"2.0", number.encode(), 1)
    assert number.encode() in payload
    with pytest.raises(UnusableInput, match=r"is no finite number"):
        documents.decode(Plan, payload)


def test_an_illegal_curve_names_its_fault() -> None:
    document = documents.to_document(a_path())
    document["curve"]["weights"] = [1.0, -1.0]
    with pytest.raises(UnusableInput, match="weights are positive"):
        documents.from_document(LearnedPath, document)
