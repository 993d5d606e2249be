"""What people call things, beside the id: any letters, spaces and signs; and the id that is made of it."""

import re
import unicodedata
from typing import Final

from teachpath_proto.keys import is_name

MAX_LENGTH: Final = 80  # characters
MAX_ID_LENGTH: Final = 64
# Letters that fall apart into no letter and marks, and those whose marks German and Danish write as letters.
SPELLINGS: Final = {
    "ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss", "æ": "ae", "œ": "oe", "ø": "oe", "å": "aa", "ł": "l", "đ": "d",
    "ð": "d", "þ": "th", "ı": "i",
}  # fmt: skip
ALIKE_SCRIPTS: Final = ("LATIN", "GREEK", "CYRILLIC")  # whose letters look alike


def id_of(text: str) -> str:
    """Return the id that a thing of this display name gets: the same one for the same text, wherever it is typed.

    A text that may be an id stays as it is. Else letters become small and lose their marks (ä, ö, ü: ae, oe, ue), a
    letter of another script becomes "u" and its number in Unicode, and all else one "-". Empty: no letter or digit is
    in it.
    """
    text = unicodedata.normalize("NFC", text.strip())
    if is_name(text):
        return text
    spelled = "".join(SPELLINGS.get(letter, letter) for letter in text.lower())
    plain = (c for c in unicodedata.normalize("NFKD", spelled) if not unicodedata.category(c).startswith("M"))
    joined = re.sub(r"\.{2,}", ".", re.sub(r"-+", "-", "".join(map(_piece, plain))))
    return joined.strip("-._")[:MAX_ID_LENGTH].strip("-._")


def checked_display_name(text: str) -> str:
    """Return a display name as it is kept: without spaces around it, its marks joined to their letters (NFC).

    Raises:
        ValueError: it cannot be one; the sentence says why.
    """
    kept = unicodedata.normalize("NFC", text.strip())
    if len(kept) > MAX_LENGTH:
        raise ValueError(f"a display name has at most {MAX_LENGTH} characters, not {len(kept)}")
    for letter in kept:
        if letter != " " and unicodedata.category(letter)[0] in "CZ":
            raise ValueError(
                f"a display name is one line of visible letters, and U+{ord(letter):04X} is none; leave it out"
            )
    scripts = [script for script in ALIKE_SCRIPTS if any(_is_of(letter, script) for letter in kept)]
    if len(scripts) > 1:
        mixed = " and ".join(script.capitalize() for script in scripts)
        raise ValueError(f"{kept!r} mixes {mixed} letters, which look alike; write it in one of them")
    if kept and not id_of(kept):
        raise ValueError(f"{kept!r} has no letter and no digit; write at least one")
    return kept


def _piece(letter: str) -> str:
    if letter in "abcdefghijklmnopqrstuvwxyz0123456789._-":
        return letter
    return f"u{ord(letter):x}" if unicodedata.category(letter)[0] in "LN" else "-"


def _is_of(letter: str, script: str) -> bool:
    return letter.isalpha() and unicodedata.name(letter, "").startswith(script)
