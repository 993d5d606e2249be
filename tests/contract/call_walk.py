"""How often somebody who reads a function from top to bottom, and steps into what it calls, comes back to a file.

The walk goes depth first through the call tree, in the order of the source, and enters each function once, where it is
first mentioned. It writes down the file of every function that it enters; files in a row count once. A *revisit* is an
entry into a file that was entered before and left since. Returns to a caller do not count: they need no page turned.

Calls are found in the source alone: functions by the names that a module defines or imports, methods by their name
where one class of the package alone has it. Records without a constructor of their own are values, not stations.
"""

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

Key = tuple[str, str]  # module, and the function's name in it


@dataclass
class Package:
    """The functions of a package by module and name, and what its modules import from each other."""

    functions: dict[Key, ast.FunctionDef] = field(default_factory=dict)
    imports: dict[str, dict[str, Key]] = field(default_factory=dict)
    methods: dict[str, list[Key]] = field(default_factory=dict)

    @classmethod
    def read(cls, folder: Path, name: str) -> "Package":
        found = cls()
        for file in sorted(folder.rglob("*.py")):
            module = ".".join([name, *file.relative_to(folder).with_suffix("").parts])
            found._read_module(module, ast.parse(file.read_text()))
        return found

    def _read_module(self, module: str, tree: ast.Module) -> None:
        names = self.imports.setdefault(module, {})
        for node in tree.body:
            if isinstance(node, ast.ImportFrom) and node.module:
                names |= {alias.asname or alias.name: (node.module, alias.name) for alias in node.names}
            elif isinstance(node, ast.FunctionDef):
                self.functions[module, node.name] = node
            elif isinstance(node, ast.ClassDef):
                for inner in node.body:
                    if isinstance(inner, ast.FunctionDef):
                        key = (module, f"{node.name}.{inner.name}")
                        self.functions[key] = inner
                        self.methods.setdefault(inner.name, []).append(key)

    def walk(self, start: Key) -> Iterator[Key]:
        """Yield the functions in the order in which the walk enters them."""
        entered: set[Key] = set()
        waiting = [start]
        while waiting:
            key = waiting.pop()
            if key in entered:
                continue
            entered.add(key)
            yield key
            waiting += reversed(list(self.mentioned(key)))

    def mentioned(self, key: Key) -> Iterator[Key]:
        """Yield the functions of the package that a function mentions, in the order of its source."""
        nodes = [node for statement in self.functions[key].body for node in _without_annotations(statement)]
        places = [node for node in nodes if isinstance(node, ast.Name | ast.Attribute)]
        for node in sorted(places, key=lambda node: (node.end_lineno, node.end_col_offset)):
            target = self._target(key[0], node)
            if target is not None:
                yield target

    def _target(self, module: str, node: ast.Name | ast.Attribute) -> Key | None:
        if isinstance(node, ast.Name):
            home, name = self.imports[module].get(node.id, (module, node.id))
            candidates = [(home, name), (home, f"{name}.__init__")]
            return next((key for key in candidates if key in self.functions), None)
        if isinstance(node.value, ast.Name):
            home, name = self.imports[module].get(node.value.id, (module, node.value.id))
            for key in ((f"{home}.{name}", node.attr), (home, f"{name}.{node.attr}")):
                if key in self.functions:
                    return key
        alone = self.methods.get(node.attr, [])
        return alone[0] if len(alone) == 1 else None


def revisits(entered: list[str]) -> list[str]:
    """Return the files that were come back to, one for each time."""
    seen: set[str] = set()
    found = []
    for before, file in zip([None, *entered], entered, strict=False):
        if file != before and file in seen:
            found.append(file)
        seen.add(file)
    return found


def _without_annotations(node: ast.AST) -> Iterator[ast.AST]:
    yield node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns"):
            continue
        for inner in value if isinstance(value, list) else [value]:
            if isinstance(inner, ast.AST):
                yield from _without_annotations(inner)
