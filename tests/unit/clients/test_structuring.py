"""JSON documents as records of the client."""

import json
from dataclasses import asdict

import pytest

from teachpath_client.models import Demonstration, Difference, Extreme, Fit, Job, Scene, Shape, Trajectory
from teachpath_client.structuring import structured

SHAPE = Shape("block", "box", [0.1, 0.1, 0.1], (0.0, 0.0, 0.5), 1, (1.0, 0.0, 0.0, 0.0), "", [(0.0, 0.0, 0.0)])


@pytest.mark.parametrize(
    "record",
    [
        Scene("paper", [SHAPE], SHAPE),
        Scene("empty", [], None),
        Trajectory([0.0, 0.1], [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], None),
        Fit(0.1, 0.2, 0.3, 0.4, None, 0.5),
        Job("j", "t", "learn", {"settings": {"seed": 1}}, "queued", 0.0, "", "", 0, 1, 0, None, ""),
        Difference(0.1, 0.2, 0.3, None, "said"),
    ],
    ids=lambda record: type(record).__name__,
)
def test_a_record_comes_back_from_its_document(record: object) -> None:
    assert structured(type(record), json.loads(json.dumps(asdict(record)))) == record  # type: ignore[call-overload]


def test_whole_numbers_are_numbers_and_what_is_not_known_is_left_out() -> None:
    found = structured(Extreme, {"value": 1, "place": "here", "s": 0, "later": [1]})
    assert found == Extreme(1.0, "here", 0.0)
    assert isinstance(found.value, float)


def test_a_list_of_records_and_what_has_a_default() -> None:
    (scene,) = structured(list[Scene], [{"name": "bare"}])
    assert scene == Scene("bare", [], None)


@pytest.mark.parametrize("document", [{}, {"id": "d"}])
def test_a_field_that_is_missing_is_named(document: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="a Demonstration has no "):
        structured(Demonstration, document)
