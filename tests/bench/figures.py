"""make figures: what the source looks like in numbers; ARGS=--install and --setup measure the service as installed.

With `--tree FOLDER` another state of the source is counted, such as one that `git archive` has written, to compare.
"""

import argparse
import ast
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from tests.bench.report import machine
from tests.contract.call_walk import Package, revisits

ROOT = Path(__file__).parents[2]
ROOMS = ("service/teachpath", "clients", "proto/teachpath_proto")
REPORT_FOLDERS = ("service/teachpath/offline/report", "clients/web/report")
LEFT_OUT = ("migrations", "_pb2", "vendor", "node_modules", "/help/")
MIB = 1 << 20
Definition = ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef


@dataclass(frozen=True)
class SourceFigures:
    """What modules of Python have: public definitions are those whose names do not begin with an underscore."""

    modules: int
    lines: int
    functions: int
    public: int
    explained: int

    @classmethod
    def of(cls, sources: list[str]) -> "SourceFigures":
        """Count sources; private definitions, and what is defined within functions, need no docstring."""
        trees = [ast.parse(source) for source in sources]
        functions = [
            node
            for tree in trees
            for node in ast.walk(tree)
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
        ]
        public = [node for tree in trees for node in _public(tree)]
        lines = sum(len(source.splitlines()) for source in sources)
        explained = sum(ast.get_docstring(node) is not None for node in public)
        return cls(len(sources), lines, len(functions), len(public), explained)


def _public(tree: ast.Module | ast.ClassDef) -> Iterator[Definition]:
    for node in tree.body:
        if isinstance(node, Definition) and not node.name.startswith("_"):
            yield node
            if isinstance(node, ast.ClassDef):
                yield from _public(node)


def sources(tree: Path, folders: tuple[str, ...], suffix: str) -> list[str]:
    """Return the texts of the files of some folders, without what is generated or others' work."""
    found = [file for folder in folders for file in sorted((tree / folder).rglob(f"*{suffix}"))]
    return [file.read_text(encoding="utf-8") for file in found if not any(part in file.as_posix() for part in LEFT_OUT)]


def plan_walk(tree: Path) -> tuple[int, int, int]:
    """Return how many functions of `motion` one enters who reads `plan`, and how often a module is come back to.

    The second count is of the modules that `plan` lies among, the third of all modules of `motion`.
    """
    motion = tree / "service" / "teachpath" / "motion"
    start = "teachpath.motion.planning.plan" if (motion / "planning").exists() else "teachpath.motion.plan"
    entered = [module for module, _ in Package.read(motion, "teachpath.motion").walk((start, "plan"))]
    home = start.rpartition(".")[0] + "."
    return (
        len(entered),
        len(revisits([module for module in entered if module.startswith(home)])),
        len(revisits(entered)),
    )


def installed_size(tree: Path) -> list[tuple[str, float]]:
    """Install the service alone as `make setup` does, by its pins; return what it takes on the disk [MiB]."""
    with tempfile.TemporaryDirectory() as folder:
        python = _new_environment(Path(folder) / "env")
        before = _size(Path(folder))
        pins = ["--require-hashes", "-r", str(tree / "requirements" / "service.txt")]
        for what in (pins, ["--no-build-isolation", str(tree)]):
            subprocess.run([python, "-m", "pip", "install", "-qqq", "--no-deps", *what], check=True)
        package = sum(_size(found) for found in Path(folder).glob("env/lib/*/site-packages/teachpath*"))
        return [("its packages", package / MIB), ("with all libraries", (_size(Path(folder)) - before) / MIB)]


def setup_times(tree: Path) -> list[tuple[str, float]]:
    """Set up a fresh copy of the source for the service alone; return how long it takes by uv and by pip [s]."""
    found = []
    for name, choice in (("by uv", []), ("by pip alone", ["UV="])):
        with tempfile.TemporaryDirectory() as folder:
            archive = subprocess.run(["git", "archive", "HEAD"], cwd=tree, check=True, capture_output=True).stdout
            subprocess.run(["tar", "-x", "-C", folder], input=archive, check=True)
            began = time.monotonic()
            subprocess.run(["make", "-s", *choice, ".venv/.service"], cwd=folder, check=True)
            found.append((name, time.monotonic() - began))
    return found


def _new_environment(folder: Path) -> str:
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    return str(folder / "bin" / "python")


def _size(path: Path) -> int:
    return sum((Path(at) / name).lstat().st_size for at, _, names in os.walk(path) for name in names)


def main() -> None:
    """Count and print."""
    parser = argparse.ArgumentParser(description="Count the source, and measure the service as installed.")
    parser.add_argument("--tree", type=Path, default=ROOT, help="the source to count; this one")
    parser.add_argument("--install", action="store_true", help="also the size of the installed service")
    parser.add_argument("--setup", action="store_true", help="also how long the set-up takes: nothing else should run")
    asked = parser.parse_args()
    source = SourceFigures.of(sources(asked.tree, ROOMS, ".py"))
    page = sources(asked.tree, ("clients/web",), ".js")
    entered, within, everywhere = plan_walk(asked.tree)
    print(f"Python without tests: {source.modules} modules, {source.lines} lines, {source.functions} functions")
    print(
        f"docstrings: {source.explained} of {source.public} public definitions ({source.explained / source.public:.1%})"
    )
    print(f"page: {len(page)} modules, {sum(len(text.splitlines()) for text in page)} lines")
    report = [text for suffix in (".py", ".js") for text in sources(asked.tree, REPORT_FOLDERS, suffix)]
    print(f"report package: {sum(len(text.splitlines()) for text in report)} lines")
    print(f"walk of plan(): {entered} functions; modules come back to: {within} in planning, {everywhere} in motion")
    if asked.install:
        print("installed service: " + ", ".join(f"{what} {size:.1f} MiB" for what, size in installed_size(asked.tree)))
    if asked.setup:
        print(
            f"set-up on {machine()}: " + ", ".join(f"{way} {seconds:.1f} s" for way, seconds in setup_times(asked.tree))
        )


if __name__ == "__main__":
    main()
