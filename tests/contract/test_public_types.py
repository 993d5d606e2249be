"""What others import is typed: a type checker of theirs must not guess at a public attribute."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = ("clients/teachpath_client", "proto/teachpath_proto", "service/teachpath")
MODULES = [
    file for package in PACKAGES for file in sorted((ROOT / package).rglob("*.py")) if not file.name.endswith("_pb2.py")
]


def guessed(tree: ast.Module) -> Iterator[str]:
    """Yield the public attributes that methods of a module's classes set, and that nothing in the class annotates."""
    for owner in ast.walk(tree):
        if not isinstance(owner, ast.ClassDef) or owner.name.startswith("_"):
            continue
        nodes = list(ast.walk(owner))
        annotated = {
            ast.unparse(node.target).removeprefix("self.") for node in nodes if isinstance(node, ast.AnnAssign)
        }
        targets = [target for node in nodes if isinstance(node, ast.Assign) for target in node.targets]
        each = [part for target in targets for part in (target.elts if isinstance(target, ast.Tuple) else [target])]
        names = [ast.unparse(part) for part in each if isinstance(part, ast.Attribute)]
        set_here = {name.removeprefix("self.") for name in names if re.fullmatch(r"self\.[a-z]\w*", name)}
        yield from (f"{owner.name}.{name}" for name in sorted(set_here - annotated))


@pytest.mark.parametrize("file", MODULES, ids=lambda file: str(file.relative_to(ROOT)))
def test_every_public_attribute_says_its_type(file: Path) -> None:
    assert list(guessed(ast.parse(file.read_text()))) == []


def test_an_attribute_without_a_type_is_found() -> None:
    said = "class A:\n def __init__(self, x: int) -> None:\n  self.b, self._c = x, x\n  self.d: int = x"
    assert list(guessed(ast.parse(said))) == ["A.b"]
