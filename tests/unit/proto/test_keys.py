"""The one rule for names, and the one sentence that tells it."""

import ast
import re
import string
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from teachpath_proto.keys import NAME, is_name, name_refusal

ROOT = Path(__file__).parents[3]
LETTERS = string.ascii_letters + string.digits
NEAR_NAMES = st.text(st.sampled_from(LETTERS + "._-é \n/"), max_size=70)


@given(NEAR_NAMES)
@example("a" * 64)
@example("a" * 65)
@example("a..b")
@example("-a")
@example("a\n")
def test_the_rule_is_what_its_sentence_says(text: str) -> None:
    obeys = (
        1 <= len(text) <= 64
        and set(text) <= set(LETTERS + "._-")
        and not text.startswith((".", "_", "-"))
        and ".." not in text
    )
    assert is_name(text) is obeys


@pytest.mark.parametrize("text", ["a..b", "-a", "", "x" * 65])
def test_the_sentence_tells_all_of_it(text: str) -> None:
    sentence = name_refusal("task", text)
    assert repr(text[:80]) in sentence
    for part in (
        "1 to 64",
        "letters a to z and A to Z",
        "digits",
        "'.', '_' and '-'",
        "begin with",
        "never write '..'",
    ):
        assert part in sentence


def test_nobody_states_the_rule_again() -> None:
    for folder in ("service", "clients"):
        for file in (ROOT / folder).rglob("*.py"):
            texts = [node.value for node in ast.walk(ast.parse(file.read_text())) if isinstance(node, ast.Constant)]
            again = [text for text in texts if isinstance(text, str) and re.search(r"A-Za-z0-9|cannot name a", text)]
            assert not again, f"{file} states the rule {NAME.pattern} again: {again}"
