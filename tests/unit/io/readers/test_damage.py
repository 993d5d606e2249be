"""Damaged files of every format end in a sentence, or in motions that are sound.

`python -m tests.unit.io.readers.test_damage COUNT` tries so many files in all.
"""

import sys
from collections import Counter

import numpy as np
import pytest

from teachpath.errors import UnusableInput
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import ReadOptions
from teachpath.io.readers.registry import read_motions
from teachpath.io.wire import MAX_COORDINATE
from teachpath.offline.track_samples import PhaseMarks, samples_of
from teachpath.recording.settings import RecordingSettings
from tests.unit.io.readers.test_formats import FILES

FILES_EACH = 1112
LONGEST_FILE = 2000  # characters of a sentence
LIMITS, SETTINGS = ImportSettings(), RecordingSettings()
PIECES = [
    b"",
    b"\0",
    b"\xff\xfe",
    b"nan",
    b"1e400",
    b"-",
    b",,",
    b";",
    b"\n\n",
    b'"',
    b"9" * 400,
    b"0x1",
    b"#",
    b"\r",
    b"=",
    b"[[",
]


def damaged(content: bytes, rng: np.random.Generator) -> bytes:
    """Return a file with a few bits flipped, bytes cut out, doubled, exchanged, or pieces put in."""
    changed = bytearray(content)
    for _ in range(int(rng.integers(1, 6))):
        a, b = sorted(rng.integers(0, len(changed) + 1, 2).tolist()) if changed else (0, 0)
        match int(rng.integers(0, 6)):
            case 0 if changed:
                changed[min(a, len(changed) - 1)] ^= 1 << int(rng.integers(0, 8))
            case 1:
                del changed[a : min(b, a + int(rng.integers(1, 200)))]
            case 2:
                del changed[a:]
            case 3:
                changed[a:a] = changed[a : min(b, a + 300)]
            case _:
                changed[a:a] = PIECES[int(rng.integers(0, len(PIECES)))]
    return bytes(changed)


def end_of(kind: str, number: int) -> str:
    """Read one damaged file and return how that ended: `read`, or the sentence."""
    name, content = FILES[kind]
    random = np.random.default_rng([number, list(FILES).index(kind)])
    given = kind if random.random() < 0.5 else ""
    try:
        found = read_motions(damaged(content, random), name, given, ReadOptions(), LIMITS)
        for track in found.tracks:
            samples = samples_of(track, name, PhaseMarks(), SETTINGS).samples
            assert all(np.isfinite(s.position).all() and max(map(abs, s.position)) <= MAX_COORDINATE for s in samples)
    except UnusableInput as error:
        return str(error)
    return "read"


@pytest.mark.parametrize("kind", FILES)
def test_a_damaged_file_ends_in_a_sentence_or_in_sound_motions(kind: str) -> None:
    ends = [end_of(kind, number) for number in range(FILES_EACH)]
    assert all(end == "read" or (name_of(kind) in end and len(end) < LONGEST_FILE) for end in ends)


def name_of(kind: str) -> str:
    return FILES[kind][0]


if __name__ == "__main__":
    each = int(sys.argv[1]) // len(FILES)
    print({kind: dict(Counter(end_of(kind, n) == "read" for n in range(each))) for kind in FILES})
