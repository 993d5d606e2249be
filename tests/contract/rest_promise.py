"""What version 1 of the REST API promises to programs, and what would break it.

`python -m tests.contract.rest_promise` writes rest_v1.json, for a release; it refuses while a promise is broken.
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.contract import openapi
from tests.contract.rest_values import Values

PROMISE = Path(__file__).with_name("rest_v1.json")
TEXTS = ("description", "title", "summary", "examples", "tags", "info", "servers")  # for people


def without_texts(node: Any, *, names: bool = False) -> Any:
    """Return a description without what is only said to people; `names`: the keys are those of fields."""
    if isinstance(node, dict):
        kept = {key: value for key, value in node.items() if names or key not in TEXTS}
        return {key: without_texts(value, names=not names and key == "properties") for key, value in kept.items()}
    return [without_texts(each) for each in node] if isinstance(node, list) else node


def broken(promised: dict[str, Any], present: dict[str, Any]) -> Iterator[str]:
    """Yield why a program that was written for a promised description may fail at the present one.

    New operations, parameters that may be left out, fields and refusals break nothing.
    """
    taken = Values(wide=present, narrow=promised, are_answers=False)
    given = Values(wide=promised, narrow=present, are_answers=True)
    refusal = {"$ref": "#/components/schemas/Refusal"}
    yield from given.faults("a refusal", refusal, refusal)
    for path, methods in promised["paths"].items():
        for method, before in methods.items():
            now = present["paths"].get(path, {}).get(method)
            place = f"{method.upper()} {path}"
            if now is None:
                yield f"{place} is gone"
                continue
            for what in ("operationId", "security"):
                if now.get(what) != before.get(what):
                    yield f"{place}: {what} was {before.get(what)} and is {now.get(what)}"
            yield from _parameters(place, before, now, taken)
            yield from _bodies(place, before, now, taken)
            yield from _answers(place, before, now, given)


def _parameters(place: str, before: dict[str, Any], now: dict[str, Any], taken: Values) -> Iterator[str]:
    old, new = ({(p["in"], p["name"]): p for p in each.get("parameters", [])} for each in (before, now))
    for key, parameter in new.items():
        if parameter["required"] and not (key in old and old[key]["required"]):
            yield f"{place} needs {' '.join(key)}"
    for key, parameter in old.items():
        if key not in new:
            yield f"{place} does not take {' '.join(key)} any more"
        else:
            yield from taken.faults(f"{place} {' '.join(key)}", new[key]["schema"], parameter["schema"])


def _bodies(place: str, before: dict[str, Any], now: dict[str, Any], taken: Values) -> Iterator[str]:
    old, new = (each.get("requestBody", {}) for each in (before, now))
    if new.get("required") and not old.get("required"):
        yield f"{place} needs a body"
    for media, content in old.get("content", {}).items():
        if media not in new.get("content", {}):
            yield f"{place} does not take {media} any more"
        else:
            yield from taken.faults(f"{place} body", new["content"][media]["schema"], content["schema"])


def _answers(place: str, before: dict[str, Any], now: dict[str, Any], given: Values) -> Iterator[str]:
    old, new = ({s: r for s, r in each["responses"].items() if s < "400"} for each in (before, now))
    if old.keys() != new.keys():
        yield f"{place} answers {', '.join(new)}, not {', '.join(old)}"
    for status in old.keys() & new.keys():
        for header in old[status].get("headers", {}).keys() - new[status].get("headers", {}).keys():
            yield f"{place} {status} has no {header} any more"
        media = old[status].get("content", {})
        if media.keys() != (answered := new[status].get("content", {})).keys():
            yield f"{place} {status} is {', '.join(answered)}, not {', '.join(media)}"
        for kind in media.keys() & answered.keys():
            yield from given.faults(f"{place} {status}", media[kind]["schema"], answered[kind]["schema"])


def main() -> None:
    """Write the description that the next changes have to keep."""
    present = without_texts(json.loads(openapi.FILE.read_text()))
    if PROMISE.exists() and (faults := list(broken(json.loads(PROMISE.read_text()), present))):
        sys.exit("\n".join(["version 1 promises otherwise; take it back, or serve it under /api/v2:", *faults]))
    for methods in present["paths"].values():
        for operation in methods.values():  # every refusal has the same form
            operation["responses"] = {s: r for s, r in operation["responses"].items() if s < "400"}
    schemas = present["components"]["schemas"]
    for field in ("type", "error"):
        del schemas["Refusal"]["properties"][field]["enum"]  # kinds of errors may come
    del schemas["JournalVerb"]["enum"]  # so may verbs
    PROMISE.write_text(json.dumps(present, separators=(",", ":")).replace('},"', '},\n"') + "\n")


if __name__ == "__main__":
    main()
