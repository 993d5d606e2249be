"""Finds in the source of a module what a pure room must not have: state of the process, clocks and chance.

A pure function answers the same to the same arguments, whatever was computed before in the process. So a module of a
pure room keeps nothing that changes: no `global`, no change of what a module-level name holds, no instance of a class
that is not frozen; and it asks no clock and no generator that was not seeded. Caches of pure functions are no state.
"""

import ast
from collections.abc import Iterator

OUTSIDE_MODULES = {"os", "io", "socket", "subprocess", "pathlib", "threading", "asyncio", "requests", "urllib"}
CLOCKS_AND_CHANCE = {"time", "datetime", "uuid", "random", "secrets"}
MUTATORS = {
    "add", "append", "appendleft", "clear", "discard", "extend", "fill", "insert", "pop", "popleft", "popitem",
    "remove", "reverse", "setdefault", "setflags", "sort", "update",
}  # fmt: skip
SEEDED = {"Generator", "default_rng", "SeedSequence"}


def mutable_classes(source: str) -> set[str]:
    """Return the classes of a module whose instances can change: neither frozen dataclasses, enums nor tuples."""
    classes = [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.ClassDef)]
    return {node.name for node in classes if not _is_frozen(node)}


def impurities(source: str, mutable: set[str]) -> list[str]:
    """Return what makes a module impure, each as a sentence with its line.

    Args:
        source: of the module.
        mutable: names of the classes, here and elsewhere, whose instances can change.
    """
    tree = ast.parse(source)
    held = set(_module_names(tree))
    found = [*_imports(tree), *_instances(tree, mutable), *_chance(tree)]
    for function in ast.walk(tree):
        if isinstance(function, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            found += _changes(function, held - _local_names(function))
    return sorted(set(found))


def _is_frozen(node: ast.ClassDef) -> bool:
    bases = {ast.unparse(base).split("[")[0].split(".")[-1] for base in node.bases}
    if bases & {"Enum", "StrEnum", "IntEnum", "NamedTuple", "Protocol"} or any(
        base.endswith("Error") for base in bases
    ):
        return True
    return any("dataclass" in ast.unparse(mark) and "frozen=True" in ast.unparse(mark) for mark in node.decorator_list)


def _module_names(tree: ast.Module) -> Iterator[str]:
    for node in tree.body:
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        for target in targets:
            yield from (name.id for name in ast.walk(target) if isinstance(name, ast.Name))


def _local_names(function: ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) -> set[str]:
    arguments = {argument.arg for argument in ast.walk(function.args) if isinstance(argument, ast.arg)}
    body = function.body if isinstance(function.body, list) else [function.body]
    stores = {
        node.id
        for statement in body
        for node in ast.walk(statement)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    }
    shared = {name for node in ast.walk(function) if isinstance(node, ast.Global) for name in node.names}
    return (arguments | stores) - shared


def _imports(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
        for name in names:
            if name.split(".")[0] in OUTSIDE_MODULES | CLOCKS_AND_CHANCE:
                yield f"line {node.lineno}: imports {name}"


def _instances(tree: ast.Module, mutable: set[str]) -> Iterator[str]:
    for node in tree.body:
        value = node.value if isinstance(node, ast.Assign | ast.AnnAssign) else None
        for inner in ast.walk(value) if value is not None else ():
            if isinstance(inner, ast.Call) and ast.unparse(inner.func).split(".")[-1] in mutable:
                yield f"line {inner.lineno}: the module holds {ast.unparse(inner)}, which can change"


def _chance(tree: ast.Module) -> Iterator[str]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and ast.unparse(node.func).endswith("default_rng") and not node.args:
            yield f"line {node.lineno}: a generator without a seed"
        numpys = isinstance(node, ast.Attribute) and ast.unparse(node.value) in ("np.random", "numpy.random")
        if numpys and node.attr not in SEEDED:
            yield f"line {node.lineno}: {ast.unparse(node)} is shared by the whole process"


def _changes(function: ast.AST, held: set[str]) -> Iterator[str]:
    for node in ast.walk(function):
        changed: ast.expr | None = None
        if isinstance(node, ast.Global):
            yield f"line {node.lineno}: global {', '.join(node.names)}"
        elif isinstance(node, ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store | ast.Del):
            changed = node
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in MUTATORS:
            changed = node.func
        if changed is not None and (name := _root(changed)) in held:
            yield f"line {changed.lineno}: changes {name}"


def _root(node: ast.expr) -> str | None:
    while isinstance(node, ast.Attribute | ast.Subscript):
        node = node.value
    return node.id if isinstance(node, ast.Name) else None
