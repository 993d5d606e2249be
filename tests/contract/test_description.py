"""The description of the REST API: complete, so that a program can be written from it alone."""

import json
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from types import NoneType
from typing import Any, get_args

import pytest
from fastapi.routing import iter_route_contexts
from jsonschema import Draft202012Validator
from referencing import Registry, Resource
from referencing.jsonschema import DRAFT202012

import teachpath
import teachpath_client
import teachpath_proto
from tests.contract import openapi
from tests.contract.desk import Desk

DESCRIPTION: dict[str, Any] = json.loads(openapi.FILE.read_text())
SCHEMAS: dict[str, Any] = DESCRIPTION["components"]["schemas"]
OPERATIONS = {
    operation["operationId"]: operation for methods in DESCRIPTION["paths"].values() for operation in methods.values()
}


def properties() -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield every field of every body and answer, with its place."""
    for name, schema in SCHEMAS.items():
        yield from ((f"{name}.{field}", kind) for field, kind in schema.get("properties", {}).items())


def test_every_field_is_described() -> None:
    assert [place for place, kind in properties() if not kind.get("description")] == []


def test_every_time_says_its_unit_and_has_64_bits() -> None:
    times = {place: kind for place, kind in properties() if place.endswith("_ns")}
    assert len(times) > 20
    assert [place for place, kind in times.items() if "[ns" not in kind["description"]] == []
    assert [place for place, kind in times.items() if kind.get("format") != "int64"] == []


@pytest.mark.parametrize("name", OPERATIONS)
def test_every_operation_is_described(name: str) -> None:
    operation = OPERATIONS[name]
    assert re.fullmatch("[a-z_]{5,30}", name)
    assert operation["description"]
    assert set(operation["tags"]) <= {tag["name"] for tag in DESCRIPTION["tags"]}
    assert [each["name"] for each in operation.get("parameters", []) if not each.get("description")] == []
    for status, response in operation["responses"].items():
        assert (status in ("204",)) != ("content" in response), status
        assert all(media["schema"] for media in response.get("content", {}).values()), status
        if status >= "400":
            assert list(response["content"]) == ["application/problem+json"]


def test_what_begins_something_says_where_it_is() -> None:
    begun = {
        name: operation["responses"]["202"] for name, operation in OPERATIONS.items() if "202" in operation["responses"]
    }
    assert len(begun) >= 6
    assert [name for name, response in begun.items() if "Location" not in response.get("headers", {})] == []


def test_every_model_has_an_example_of_its_own_form() -> None:
    shown = {name: schema for name, schema in SCHEMAS.items() if "properties" in schema}
    assert len(shown) > 100
    document = Resource(DESCRIPTION, DRAFT202012)
    registry: Registry[Any] = Registry().with_resource("urn:api", document)
    faults = []
    for name, schema in shown.items():
        (example,) = schema["examples"]
        check = Draft202012Validator({"$ref": f"urn:api#/components/schemas/{name}"}, registry=registry)
        faults += [f"{name} {error.json_path}: {error.message}" for error in check.iter_errors(example)]
        assert example, name
    assert faults == []


def test_every_example_of_a_request_can_be_sent(desk: Desk) -> None:
    fields = [getattr(route, "body_field", None) for route in iter_route_contexts(desk.station.web.routes)]
    bodies = [field.field_info.annotation for field in fields if field is not None]
    models = {next(each for each in (*get_args(body), body) if each is not NoneType) for body in bodies}
    assert len(models) > 20
    for model in models:
        model.model_validate(SCHEMAS[model.__name__]["examples"][0])


def test_every_operation_says_whether_it_asks_who_sends() -> None:
    assert [name for name, operation in OPERATIONS.items() if "security" not in operation] == []
    assert {"contact", "license"} <= set(DESCRIPTION["info"])
    assert DESCRIPTION["servers"]


def test_the_glossary_has_every_word_of_the_addresses() -> None:
    glossary = (Path(__file__).parents[2] / "docs" / "glossary.md").read_text().lower()
    said = set(re.findall(r"[a-z]+", glossary))
    steps = {step for path in DESCRIPTION["paths"] for step in path.split("/")[3:] if "{" not in step}
    needed = {word for step in steps for word in step.split("-")} - {"password"}
    assert len(needed) > 50
    assert [word for word in sorted(needed) if not {word, word.removesuffix("s"), word.removesuffix("es")} & said] == []


def test_every_kind_of_refusal_is_listed(desk: Desk) -> None:
    kinds = SCHEMAS["Refusal"]["properties"]["type"]["enum"]
    assert len(set(kinds)) == len(kinds) > 20
    answer = desk.get("/tasks/moon")
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert (problem["type"], problem["status"], problem["error"]) == ("urn:teachpath:error:NotFound", 404, "NotFound")
    assert problem["type"] in kinds
    assert problem["title"] == "There is nothing of that name"
    assert desk.get("/nothing").json()["type"] == "about:blank"


def test_all_packages_and_the_changelog_have_the_version_of_the_project() -> None:
    root = Path(__file__).parents[2]
    version = tomllib.loads((root / "pyproject.toml").read_text())["project"]["version"]
    packages = (teachpath, teachpath_client, teachpath_proto)
    assert [package.__version__ for package in packages] == [version] * 3
    headings = re.findall(r"^## (.+)$", (root / "CHANGELOG.md").read_text(), re.MULTILINE)
    released = next(heading for heading in headings if heading != "Unreleased")
    assert re.fullmatch(re.escape(version) + r" - \d{4}-\d\d-\d\d", released), released
