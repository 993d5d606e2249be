"""Compiled kernels are kept from run to run, and are never older than what they call."""

import ast
import os
import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "service" / "teachpath"
CALLED_PROGRAM = "from teachpath.compiled import compiled\n@compiled()\ndef once(x):\n    return x + {}\n"
CALLER = (
    "from teachpath.compiled import compiled\nfrom kernels.called import once\n"
    "@compiled()\ndef twice(x):\n    return once(once(x))\n"
)
SCRIPT = "from kernels.caller import twice\nprint(twice(10.0), sum(twice.stats.cache_hits.values()))"
TYPES = {"Array"}  # names that a kernel may take from elsewhere: they leave nothing in its code


def twice(folder: Path) -> list[float]:
    """Run the kernel in a process of its own; returns its result, and how often it came from the disk."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(folder), str(PACKAGE.parent)])}
    done = subprocess.run([sys.executable, "-c", SCRIPT], env=environment, check=True, capture_output=True, text=True)
    return [float(word) for word in done.stdout.split()]


def test_a_kernel_is_compiled_anew_when_one_that_it_calls_has_changed(tmp_path: Path) -> None:
    package = tmp_path / "kernels"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "called.py").write_text(CALLED_PROGRAM.format("1.0"))
    (package / "caller.py").write_text(CALLER)
    assert twice(tmp_path) == [12.0, 0]
    assert twice(tmp_path) == [12.0, 1]
    (package / "called.py").write_text(CALLED_PROGRAM.format("100.0"))
    assert twice(tmp_path) == [210.0, 0]


def test_kernels_use_nothing_of_another_folder() -> None:
    kernels = {
        file
        for file in PACKAGE.rglob("*.py")
        if file != PACKAGE / "compiled.py" and any(word in file.read_text() for word in ("@compiled", "@kernel"))
    }
    assert len(kernels) > 5
    for file in kernels:
        own = ".".join(file.parent.relative_to(PACKAGE.parent).parts)
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("teachpath"):
                near = node.module == "teachpath.compiled" or f"{node.module}.".startswith(f"{own}.")
                assert near or {alias.name for alias in node.names} <= TYPES, f"{file}: {node.module}"
