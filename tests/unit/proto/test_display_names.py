"""Display names: any letters, spaces and signs, and always the same id of the same name."""

import unicodedata

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath_proto.display_names import MAX_LENGTH, checked_display_name, id_of
from teachpath_proto.keys import is_name


@pytest.mark.parametrize(
    ("text", "id"),
    [
        ("demo.V2", "demo.V2"),
        ("Küche räumen", "kueche-raeumen"),
        (" Straße, Halle 3 (Süd)!", "strasse-halle-3-sued"),
        ("naïve  café", "naive-cafe"),
        ("高台", "u9ad8u53f0"),
        ("a..b / c", "a.b-c"),
        ("—", ""),
    ],
)
def test_an_id_is_made_of_a_name(text: str, id: str) -> None:
    assert id_of(text) == id


@given(st.text(max_size=MAX_LENGTH))
def test_what_is_made_of_any_text_is_an_id_or_nothing_and_stays_one(text: str) -> None:
    made = id_of(text)
    assert made == "" or is_name(made)
    assert id_of(made) == made
    assert id_of(unicodedata.normalize("NFD", text)) == id_of(unicodedata.normalize("NFC", text))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("K\u0443che", "mixes Latin and Cyrillic letters, which look alike"),
        ("a\u200bb", "U\\+200B is none; leave it out"),
        ("a\nb", "U\\+000A is none"),
        ("a\u202eb", "U\\+202E is none"),
        ("x" * (MAX_LENGTH + 1), "at most 80 characters, not 81"),
        ("!?", "no letter and no digit"),
    ],
)
def test_a_name_that_deceives_or_says_nothing_is_refused(text: str, sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        checked_display_name(text)


def test_a_name_is_kept_as_it_is_typed() -> None:
    assert checked_display_name("  Ku\u0308che räumen (früh) ") == "Küche räumen (früh)"
    assert checked_display_name("") == ""
