"""Functions within functions: Ruff asks docstrings of what is public, and sees none of these."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
LEFT_OUT = ("migrations", "_pb2")
LONGEST_TITLE = 5  # lines that are read together with the function around them
FILES = [
    file
    for folder in ("service/teachpath", "clients", "proto/teachpath_proto")
    for file in sorted((ROOT / folder).rglob("*.py"))
    if not any(part in str(file) for part in LEFT_OUT)
]
Function = ast.FunctionDef | ast.AsyncFunctionDef


def nested(tree: ast.AST, within: bool = False) -> Iterator[Function]:
    """The functions that are declared within others."""
    for node in ast.iter_child_nodes(tree):
        is_function = isinstance(node, Function)
        if within and isinstance(node, Function):
            yield node
        yield from nested(node, within or is_function)


def unexplained(source: str) -> list[str]:
    """Those without a docstring that need one: operations of the API, and what is too long to be read in passing."""
    functions = [function for function in nested(ast.parse(source)) if not ast.get_docstring(function)]
    lines = {function: (function.end_lineno or 0) - function.lineno + 1 for function in functions}
    return [
        f"{function.name} (line {function.lineno})"
        for function in functions
        if lines[function] > LONGEST_TITLE or any("router" in ast.unparse(each) for each in function.decorator_list)
    ]


def test_operations_and_long_functions_within_functions_say_what_they_do() -> None:
    found = {str(file.relative_to(ROOT)): unexplained(file.read_text()) for file in FILES}
    assert {file: names for file, names in found.items() if names} == {}


@pytest.mark.parametrize(
    ("body", "found"),
    [
        ("    def short():\n        return 1", []),
        ("    def long():\n" + "        pass\n" * LONGEST_TITLE, ["long (line 2)"]),
        ('    def long():\n        """Do it."""\n' + "        pass\n" * LONGEST_TITLE, []),
        ("    @router.get('/')\n    def page():\n        return 1", ["page (line 3)"]),
    ],
)
def test_the_rule_finds_what_it_is_to_find(body: str, found: list[str]) -> None:
    assert unexplained(f"def around():\n{body}") == found
