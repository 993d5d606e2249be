import io

import numpy as np
import pytest

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import FileMotions, ReadOptions, Track
from teachpath.io.readers.registry import read_motions

TABLE = "t,x,y,z\n" + "".join(f"{i * 0.02:.2f},{i / 100},{2 * i / 100},0.5\n" for i in range(30))


def found(content: bytes | str, kind: str = "csv", **options: object) -> FileMotions:
    raw = content.encode() if isinstance(content, str) else content
    return read_motions(raw, "f", kind, ReadOptions(**options), ImportSettings())  # type: ignore[arg-type]


def read(content: bytes | str, kind: str = "csv", **options: object) -> list[Track]:
    return list(found(content, kind, **options).tracks)


def npy(values: object) -> bytes:
    out = io.BytesIO()
    np.save(out, values)  # type: ignore[arg-type]
    return out.getvalue()


def test_units_scale_positions_only() -> None:
    (metres,), (inches,) = read(TABLE), read(TABLE, units="in")
    assert np.allclose(inches.positions, metres.positions * 0.0254)
    assert np.array_equal(inches.times, metres.times)


def test_robottasks_makes_one_track_a_demonstration() -> None:
    values = np.zeros((3, 40, 7))
    values[..., 3] = 1.0
    values[..., 0] = np.arange(40)
    tracks = read(npy(values), "robottasks", rate=100.0)
    assert [len(t.times) for t in tracks] == [40, 40, 40]
    assert tracks[0].positions[-1, 0] == pytest.approx(0.39)
    assert tracks[0].times[-1] == pytest.approx(0.39)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("", "empty"),
        ("t,x,y,z\n", "no samples"),
        ("x,y,z\n1,2,3\n", "no column for t"),
        (TABLE + "0.7,1,2\n", "line 32: 3 values"),
        (TABLE + "0.7,1,2,x\n", "line 32"),
        ("t,x,y,z\n0.2,1,2,3\n0.1,1,2,3\n0,1,2,3\n", "sort by t"),
        (TABLE + ",1,2,3\n", "line 32: a row without a time"),
        ("t,x,y,z\n0,1,2,3\n", "too few"),
        ("t,x,y,z,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n0.1,1,2,3,0.5,0,0,0\n", "quaternion of sample 1"),
        (b"\xff\xfe\x00", "not a text file"),
    ],
)
def test_a_bad_csv_names_its_line(content: bytes | str, sentence: str) -> None:
    with pytest.raises(UnusableRecording, match=sentence):
        read(content)


def test_a_bad_array_is_a_sentence() -> None:
    good = npy(np.zeros((2, 30, 7)))
    for content, sentence in [
        (good[:-100], "not a whole"),
        (good[:10], "not a whole"),
        (b"rubbish", "not a whole"),
        (npy(np.zeros((30, 7))), "must be floats"),
        (npy(np.array([{"a": 1}], dtype=object)), "not a whole"),
        (npy(np.full((1, 30, 7), np.nan)), "0 of its 30 samples are tracked"),
        (npy(np.ones((2, 30, 7))), "quaternion"),
    ]:
        with pytest.raises(UnusableRecording, match=sentence):
            read(content, kind="robottasks")


@pytest.mark.parametrize(
    ("option", "value"),
    [("kind", "xls"), ("units", "parsec"), ("rate", 0.5), ("rate", np.nan), ("time_unit", "h"), ("columns", "x:1")],
)
def test_a_bad_option_names_what_is_known(option: str, value: object) -> None:
    with pytest.raises(UnusableInput, match=r"known|outside|write role=column"):
        read(TABLE, **{option: value})  # type: ignore[arg-type]
