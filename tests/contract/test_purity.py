"""The pure rooms keep no state of the process, ask no clock and draw nothing by chance."""

from pathlib import Path

import pytest

from tests.contract.purity import impurities, mutable_classes

SERVICE = Path(__file__).parents[2] / "service" / "teachpath"
PURE_ROOMS = ("learning", "motion", "recording")
FILES = [file for room in PURE_ROOMS for file in sorted((SERVICE / room).rglob("*.py"))]


@pytest.fixture(scope="module")
def mutable() -> set[str]:
    return {name for file in SERVICE.rglob("*.py") for name in mutable_classes(file.read_text())}


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.relative_to(SERVICE).as_posix())
def test_a_module_of_a_pure_room_is_pure(file: Path, mutable: set[str]) -> None:
    assert impurities(file.read_text(), mutable) == []


@pytest.mark.parametrize(
    ("source", "sentence"),
    [
        ("import time", "imports time"),
        ("from datetime import datetime", "imports datetime"),
        ("def f():\n    import uuid", "imports uuid"),
        ("import os.path", "imports os.path"),
        ("N = 0\ndef f():\n    global N\n    N = 1", "global N"),
        ("class Choice:\n    pass\nCHOSEN = Choice()", "the module holds Choice(), which can change"),
        ("class Choice:\n    pass\nCHOSEN = {'a': (Choice(), 1)}", "the module holds Choice(), which can change"),
        ("KNOWN = {}\ndef f(a):\n    KNOWN[a] = 1", "changes KNOWN"),
        ("KNOWN = []\ndef f(a):\n    KNOWN.append(a)", "changes KNOWN"),
        ("SETTINGS = object()\ndef f(a):\n    SETTINGS.rate += a", "changes SETTINGS"),
        ("KNOWN = {}\nf = lambda a: KNOWN.setdefault(a, 1)", "changes KNOWN"),
        ("import numpy as np\ndef f():\n    return np.random.default_rng()", "a generator without a seed"),
        ("import numpy as np\ndef f():\n    return np.random.rand()", "np.random.rand is shared"),
    ],
)
def test_what_is_impure_is_seen(source: str, sentence: str) -> None:
    assert sentence in "; ".join(impurities(source, mutable_classes(source)))


@pytest.mark.parametrize(
    "source",
    [
        "LIMIT = 3\nTABLE = {'a': 1}\ndef f(a):\n    return TABLE[a] * LIMIT",
        "KNOWN = {}\ndef f(a):\n    KNOWN = {}\n    KNOWN[a] = 1\n    return KNOWN",
        "@dataclass(frozen=True)\nclass Row:\n    a: int\nROWS = (Row(1), Row(2))",
        "class Kind(StrEnum):\n    A = 'a'\nFIRST = Kind('a')",
        "import numpy as np\ndef f(seed):\n    return np.random.default_rng(seed)",
        "from functools import cache\n@cache\ndef f(a):\n    return a + 1",
        "class Filter:\n    def add(self, row):\n        self.rows.append(row)",
    ],
)
def test_what_is_pure_is_let_be(source: str) -> None:
    assert impurities(source, mutable_classes(source)) == []
