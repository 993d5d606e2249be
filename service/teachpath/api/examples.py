"""Examples in the description of the API: one of each model, of values as a station has them."""

from __future__ import annotations

from typing import Any, Final

from teachpath.api.schemas import REFERENCE, Schema

CURVE: Final[Schema] = {
    "degree": 3,
    "knots": [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0],
    "control_points": [[0.58, -0.28, 0.52], [0.6, -0.1, 0.7], [0.55, 0.1, 0.7], [0.5, 0.3, 0.52]],
    "weights": [1.0, 1.0, 1.0, 1.0],
}
# Requests say what they must, and what a sender is likely to say.
REQUESTS: Final[dict[str, dict[str, Any]]] = {
    "CalibrationChoice": {"calibration": "lab"},
    "Credentials": {"name": "ada", "password": "correct horse battery staple"},
    "CurveBody": CURVE,
    "CurveEvaluation": {"curve": CURVE, "u": [0.0, 0.5, 1.0]},
    "CurveOperation": {"curve": CURVE, "u": 0.5},
    "CurveToAssess": {"curve": CURVE, "version": 1},
    "DemonstrationChanges": {"mark": "good", "trim": [40, 180]},
    "Examination": {"file": {"name": "cups.csv", "units": "mm"}, "task": "cups"},
    "FileChoices": {"name": "cups.csv", "units": "mm"},
    "ImportPlace": {"scene": "empty"},
    "LeaseClaim": {"name": "ada", "seconds": 5.0, "hold_when_lost": True},
    "MarkedMotion": {"motion": 1, "grasp": 0.4, "release": 2.9},
    "NewAdaptation": {"start": {"position": [0.45, -0.2, 0.5]}, "goal": {"position": [0.5, 0.3, 0.5]}},
    "NewCalibration": {
        "points": [
            {"tracker": [0.0, 0.0, 0.0], "world": [0.4, -0.3, 0.5]},
            {"tracker": [0.3, 0.0, 0.0], "world": [0.7, -0.3, 0.5]},
            {"tracker": [0.0, 0.3, 0.0], "world": [0.4, 0.0, 0.5]},
        ],
        "source": "three corners of the table",
    },
    "NewExecution": {"plan": "plan-3f2a9c1b7d5e", "override": 0.5},
    "NewImport": {"files": [{"upload": "0123456789abcdef0123456789abcdef", "name": "cups.csv", "units": "mm"}]},
    "NewJob": {"kind": "learn", "settings": {"repeats": 100}},
    "NewPassword": {"password": "correct horse battery staple"},
    "NewPerson": {"name": "ada", "password": "correct horse battery staple", "roles": ["operate"]},
    "NewPlan": {"version": 2},
    "NewRecording": {"tracker": "glove", "rate": 50.0},
    "NewTask": {"scene": "paper", "calibration": "lab"},
    "NewTeleoperation": {"tracker": "glove", "scale": 0.5, "clutch": "pedal"},
    "NewToken": {"name": "cell-3", "roles": ["operate"], "days": 30.0},
    "NewTouch": {"hold_time": 1.0},
    "NewVersion": {"base": 1, "curve": CURVE, "name": "higher over the rim", "author": "ada"},
    "Override": {"override": 0.3},
    "Page": {"path": "/"},
    "PointPair": {"tracker": [0.3, 0.0, 0.0], "world": [0.7, -0.3, 0.5]},
    "RecordingEnd": {"tracker": "glove", "discard": False},
    "Revocation": {"reason": "the table was moved"},
    "SeenObject": {"position": [0.55, -0.24, 0.52]},
    "Step": {"length": 0.02},
    "TargetPose": {"position": [0.5, 0.3, 0.5]},
    "TaskChanges": {"name": "cups"},
    "TrackerChoice": {"tracker": "glove"},
    "UploadChoices": {"upload": "0123456789abcdef0123456789abcdef", "name": "cups.csv", "units": "mm"},
}
# What answers say in fields of these names; other fields have their default, or a value of their kind.
VALUES: Final[dict[str, Any]] = {
    "branch": "main",
    "calibration": "lab@2",
    "demonstration": "demo-5c0e8d7a9b21",
    "endpoint": "tcp/127.0.0.1:7447",
    "execution": "execution-8d1f0a6e4c73",
    "file": "cups.csv",
    "fraction": 1.0,
    "holder": "ada",
    "job": "learn-9b3d5f7a1c20",
    "operator": "ada",
    "orientation": [1.0, 0.0, 0.0, 0.0],
    "path": "run-9b3d5f7a1c20-1",
    "plan": "plan-3f2a9c1b7d5e",
    "position": [0.55, -0.24, 0.52],
    "prefix": "teachpath/station",
    "recording": "cups/demo-5c0e8d7a9b21.mcap",
    "robot": "puma560",
    "run": "run-9b3d5f7a1c20",
    "scene": "paper",
    "source": "glove",
    "task": "cups",
    "token": "an example, and no token of any station",
    "tracker": "glove",
    "who": "ada",
}
MOMENT: Final = 1_764_510_000_000_000_000  # [ns since the Unix epoch]
UNSET_TIMES: Final = ("archived_ns", "discarded_ns", "revoked_ns")


def add_examples(schemas: dict[str, Schema]) -> None:
    """Give every model of a description one example."""
    for name, schema in schemas.items():
        if "properties" in schema:
            schema["examples"] = [_example(schemas, {"$ref": REFERENCE.format(model=name)}, "")]


def _example(schemas: dict[str, Schema], kind: Schema, field: str) -> Any:
    """Return a value that has the form of a schema.

    Args:
        schemas: of the description, by their names.
        kind: the schema.
        field: that has the value; empty: none.
    """
    if "$ref" in kind:
        name = kind["$ref"].rpartition("/")[2]
        properties = schemas[name].get("properties")
        if properties is None:
            return _example(schemas, schemas[name], field)
        made = {of: _example(schemas, each, of) for of, each in properties.items()}
        return REQUESTS.get(name, made)
    if "anyOf" in kind:
        return _example(schemas, kind["anyOf"][0], field)
    if "enum" in kind:
        return kind["enum"][0]
    match kind.get("type"):
        case "array":
            return _array(schemas, kind, field)
        case "object":
            values = kind.get("additionalProperties")
            return {"name": _example(schemas, values, "")} if isinstance(values, dict) else {}
        case _:
            return _scalar(kind, field)


def _array(schemas: dict[str, Schema], kind: Schema, field: str) -> list[Any]:
    if "prefixItems" in kind:
        known = VALUES.get(field)
        return known if isinstance(known, list) else [_example(schemas, each, field) for each in kind["prefixItems"]]
    return [_example(schemas, kind["items"], field)] * max(1, kind.get("minItems", 1))


def _scalar(kind: Schema, field: str) -> Any:
    known = VALUES.get(field)
    match kind.get("type"):
        case "integer" if field.endswith("_ns"):
            return 0 if field in UNSET_TIMES else MOMENT
        case "integer":
            return int(kind.get("minimum", 1))
        case "number":
            return known if isinstance(known, float) else float(kind.get("minimum", 0.5))
        case "boolean":
            return kind.get("default", False)
        case "string":
            return known if isinstance(known, str) else kind.get("default", "") or field
        case _:
            return None
