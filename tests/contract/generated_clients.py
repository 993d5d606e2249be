"""Clients that public generators make of the description of the REST API (`make generate-clients`).

None of them has an untyped answer, and the one that openapi-python-client makes teaches a station. It is no part of
`make test`: the generators have an environment of their own, and cost more than they find from day to day.
"""

import ast
import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.contract.desk import csv
from tests.contract.stations import station, web_port

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "dist" / "clients"
TOOLS = ROOT / ".venv" / "generators" / "bin"
CONFIG = ROOT / "tools" / "contract" / "openapi-python-client.yaml"
STORY = Path(__file__).with_name("generated_story.py")
TYPESCRIPT = ROOT / "tools" / "page" / "node_modules" / "openapi-typescript" / "bin" / "cli.js"


def main() -> None:
    """Generate the clients, look for untyped answers, and let one of them teach a station."""
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)
    with station() as opened, web_port(opened) as port:
        description = opened.web.openapi()
        file = FOLDER / "openapi.json"
        file.write_text(json.dumps(description))
        faults = [*python_client(file, description), *python_models(file, description), *typescript_types(file)]
        if faults:
            raise SystemExit("\n".join(faults))
        shown = [FOLDER / f"{number}.csv" for number in (1, 2, 3)]
        for number, path in enumerate(shown):
            path.write_text(csv(120, step=0.002 + 0.0001 * number))
        told = run(TOOLS / "python", STORY, f"http://127.0.0.1:{port}", *shown, env={"PYTHONPATH": str(FOLDER)})
    print(f"three generators, no untyped answer; the generated client at a station: {told}", end="")


def run(*words: Any, env: dict[str, str] | None = None) -> str:
    """Return what a program said; raises where it failed."""
    program = [str(word) for word in words]
    done = subprocess.run(program, capture_output=True, text=True, check=False, env=os.environ | (env or {}))
    if done.returncode:
        raise SystemExit(f"{' '.join(program)}:\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def python_client(file: Path, description: dict[str, Any]) -> Iterator[str]:
    """Generate a client by openapi-python-client, and yield what it warns of and which answers are of any type."""
    folder = FOLDER / "teachpath_rest"
    options = ("--config", CONFIG, "--meta", "none", "--output-path", folder)
    said = run(TOOLS / "openapi-python-client", "generate", "--path", file, *options)
    yield from re.findall(r"WARNING.*", said)
    operations = [operation for methods in description["paths"].values() for operation in methods.values()]
    nothing = {operation["operationId"] for operation in operations if "204" in operation["responses"]}
    for module in sorted((folder / "api").rglob("*.py")):
        if re.search(r"-> Response\[[^\n]*\bAny\b", module.read_text()) and module.stem not in nothing:
            yield f"openapi-python-client: the answer of {module.stem} has no type"


def python_models(file: Path, description: dict[str, Any]) -> Iterator[str]:
    """Generate models by datamodel-code-generator, and yield the fields that may be anything where we say more."""
    models = FOLDER / "models.py"
    kind = ("--output-model-type", "pydantic_v2.BaseModel", "--formatters", "black")
    run(TOOLS / "datamodel-codegen", "--input", file, "--input-file-type", "openapi", "--output", models, *kind)
    free = {
        (name, field)
        for name, schema in description["components"]["schemas"].items()
        for field, shape in schema.get("properties", {}).items()
        if '"additionalProperties": true' in json.dumps(shape)
    }
    for owner in ast.parse(models.read_text()).body:
        for node in owner.body if isinstance(owner, ast.ClassDef) else ():
            if isinstance(node, ast.AnnAssign) and re.search(r"\bAny\b", ast.unparse(node.annotation)):
                name = (owner.name, ast.unparse(node.target))  # type: ignore[union-attr]
                yield from () if name in free else [f"datamodel-code-generator: {'.'.join(name)} has no type"]


def typescript_types(file: Path) -> Iterator[str]:
    """Generate types by openapi-typescript, and yield the answers that are unknown."""
    types = FOLDER / "api.d.ts"
    run(ROOT / ".venv" / "bin" / "node", TYPESCRIPT, file, "--output", types)
    for line in types.read_text().splitlines():
        if re.search(r'"application/[^"]+": unknown', line):
            yield f"openapi-typescript: {line.strip()}"


if __name__ == "__main__":
    main()
