"""What the page and the service hold twice must be equal: the page imports no Python."""

import re
from pathlib import Path

from teachpath_proto.keys import NAME, name_refusal

WEB = Path(__file__).parents[2] / "clients" / "web"


def test_the_page_has_the_rule_for_names_pattern_and_sentence_alike() -> None:
    source = (WEB / "names.js").read_text()
    (pattern,) = re.findall(r'NAME_PATTERN = "(.*)";', source)
    assert pattern.encode().decode("unicode_escape") == NAME.pattern
    sentence = "".join(re.findall(r"^ +[`\"](.*)[`\"](?: \+|)$", source, re.MULTILINE))
    assert sentence.replace("${text.slice(0, 80)}", "a..b").replace("${what}", "task") == name_refusal("task", "a..b")
