"""A program that was written for this version's REST API goes on: what it sends is taken, what it reads is there."""

import copy
import json
from collections.abc import Callable
from typing import Any

import pytest

from tests.contract import openapi
from tests.contract.rest_promise import PROMISE, broken

PROMISED_DESCRIPTION: dict[str, Any] = json.loads(PROMISE.read_text())
PRESENT_DESCRIPTION: dict[str, Any] = json.loads(openapi.FILE.read_text())
TASK = "/api/v1/tasks/{task}"


def test_the_api_keeps_what_this_version_promised() -> None:
    assert list(broken(PROMISED_DESCRIPTION, PRESENT_DESCRIPTION)) == []


def operation(description: dict[str, Any], method: str, path: str) -> dict[str, Any]:
    found: dict[str, Any] = description["paths"][f"/api/v1{path}"][method]
    return found


def fields(description: dict[str, Any], model: str) -> dict[str, Any]:
    found: dict[str, Any] = description["components"]["schemas"][model]["properties"]
    return found


def rename_operation(d: dict[str, Any]) -> None:
    operation(d, "get", "/tasks")["operationId"] = "tasks"


def remove_operation(d: dict[str, Any]) -> None:
    del d["paths"][TASK]["delete"]


def ask_for_more_rights(d: dict[str, Any]) -> None:
    operation(d, "get", "/tasks")["security"] = [{"token": ["teach"]}]


def need_a_parameter(d: dict[str, Any]) -> None:
    operation(d, "get", "/tasks")["parameters"][0]["required"] = True


def drop_a_parameter(d: dict[str, Any]) -> None:
    operation(d, "get", "/tasks")["parameters"].pop(0)


def lower_a_limit(d: dict[str, Any]) -> None:
    operation(d, "get", "/tasks")["parameters"][2]["schema"]["maximum"] = 50


def need_a_field(d: dict[str, Any]) -> None:
    d["components"]["schemas"]["NewTask"]["required"] = ["scene"]


def drop_a_field(d: dict[str, Any]) -> None:
    del fields(d, "NewTask")["scene"]


def change_a_default(d: dict[str, Any]) -> None:
    fields(d, "NewExecution")["override"]["default"] = 0.5


def refuse_a_word(d: dict[str, Any]) -> None:
    fields(d, "NewJob")["kind"]["enum"].remove("recut")


def answer_a_new_word(d: dict[str, Any]) -> None:
    d["components"]["schemas"]["JobState"]["enum"].append("paused")


def answer_null(d: dict[str, Any]) -> None:
    fields(d, "Job")["outcome"] = {"anyOf": [{"type": "string"}, {"type": "null"}]}


def leave_a_field_out(d: dict[str, Any]) -> None:
    d["components"]["schemas"]["Job"]["required"].remove("state")


def answer_less(d: dict[str, Any]) -> None:
    del fields(d, "Curve")["weights"]
    d["components"]["schemas"]["Curve"]["required"].remove("weights")


def answer_otherwise(d: dict[str, Any]) -> None:
    answers = operation(d, "post", "/executions")["responses"]
    answers["201"] = answers.pop("202")


def forget_the_place(d: dict[str, Any]) -> None:
    del operation(d, "post", "/executions")["responses"]["202"]["headers"]["Location"]


def refuse_without_a_sentence(d: dict[str, Any]) -> None:
    d["components"]["schemas"]["Refusal"]["required"].remove("detail")


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (rename_operation, "GET /api/v1/tasks: operationId was list_tasks and is tasks"),
        (remove_operation, f"DELETE {TASK} is gone"),
        (ask_for_more_rights, "security was"),
        (need_a_parameter, "GET /api/v1/tasks needs query archived"),
        (drop_a_parameter, "GET /api/v1/tasks does not take query archived any more"),
        (lower_a_limit, "GET /api/v1/tasks query limit: maximum is 50, and was 500"),
        (need_a_field, f"PUT {TASK} body.scene may be left out, where it must be there"),
        (drop_a_field, f"PUT {TASK} body.scene is not known any more"),
        (change_a_default, "POST /api/v1/executions body.override left out was 1.0 and is 0.5"),
        (refuse_a_word, "body.kind may be ['recut']"),
        (answer_a_new_word, ".state may be ['paused']"),
        (answer_null, ".outcome may be null, where it is string"),
        (leave_a_field_out, ".state may be left out, where it must be there"),
        (answer_less, ".weights is gone"),
        (answer_otherwise, "POST /api/v1/executions answers 201, not 202"),
        (forget_the_place, "POST /api/v1/executions 202 has no Location any more"),
        (refuse_without_a_sentence, "a refusal.detail may be left out"),
    ],
)
def test_what_breaks_a_promise_is_found(change: Callable[[dict[str, Any]], None], sentence: str) -> None:
    changed = copy.deepcopy(PROMISED_DESCRIPTION)
    change(changed)
    faults = list(broken(PROMISED_DESCRIPTION, changed))
    assert any(sentence in fault for fault in faults), faults


def test_what_is_added_breaks_nothing() -> None:
    changed = copy.deepcopy(PROMISED_DESCRIPTION)
    changed["paths"]["/api/v1/moons"] = {"get": operation(changed, "get", "/tasks")}
    operation(changed, "get", "/tasks")["parameters"].append(
        {"in": "query", "name": "moon", "required": False, "schema": {"type": "string", "default": ""}}
    )
    fields(changed, "NewTask")["moon"] = {"type": "boolean", "default": False}
    fields(changed, "Job")["moon"] = {"type": "string"}
    fields(changed, "NewJob")["kind"]["enum"].append("moon")
    assert list(broken(PROMISED_DESCRIPTION, changed)) == []
