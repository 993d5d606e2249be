"""Reads the identifiers of the source: names of files, classes, functions, attributes and constants."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

CONSTANT = re.compile(r"^(?:export )?const ([A-Z][A-Z0-9_]*) =", re.MULTILINE)
WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+")
DECLARATION = re.compile(
    r"\b(?:class|function|const|let|get|set|static)\s+#?([A-Za-z_]\w*)"  # a declaration
    r"|^\s+(?:async\s+)?#?([A-Za-z_]\w*)\([^)]*\)\s*\{$"  # a method
    r"|^\s+#?([A-Za-z_]\w*)\s*(?:=|: )",  # a field
    re.MULTILINE,
)


def python_identifiers(source: str) -> Iterator[str]:
    """Yield what a module declares: its classes, functions, attributes and constants; not its local variables."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name | ast.Attribute):
            yield _name(node.target)
        elif isinstance(node, ast.Assign):
            targets = [each for target in node.targets for each in _unpacked(target)]
            yield from (_name(each) for each in targets if isinstance(each, ast.Attribute) or _name(each).isupper())


def script_identifiers(source: str) -> Iterator[str]:
    """Yield what a module of the page declares."""
    for found in DECLARATION.finditer(source):
        yield next(name for name in found.groups() if name)


def constants(source: str, *, script: bool) -> Iterator[str]:
    """Yield the constants of a module of Python or of the page: names in capitals that stand outside of everything."""
    if script:
        yield from (found[1] for found in CONSTANT.finditer(source))
        return
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign | ast.AnnAssign):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            yield from (_name(each) for target in targets for each in _unpacked(target) if _name(each).isupper())


def words(identifier: str) -> list[str]:
    """Return the words of an identifier in small letters: `TimedPath` and `timed_path` have the same two."""
    return [word.lower() for word in WORD.findall(identifier)]


def declared(root: Path, files: list[Path]) -> Iterator[tuple[str, str]]:
    """Yield every identifier with its place; the name of a file is one too."""
    for file in files:
        place = file.relative_to(root).as_posix()
        yield file.stem, place
        read = python_identifiers if file.suffix == ".py" else script_identifiers
        for identifier in read(file.read_text(encoding="utf-8")):
            yield identifier, place


def _unpacked(target: ast.expr) -> list[ast.Name | ast.Attribute]:
    if isinstance(target, ast.Tuple | ast.List):
        return [each for element in target.elts for each in _unpacked(element)]
    return [target] if isinstance(target, ast.Name | ast.Attribute) else []


def _name(target: ast.Name | ast.Attribute) -> str:
    return target.attr if isinstance(target, ast.Attribute) else target.id
