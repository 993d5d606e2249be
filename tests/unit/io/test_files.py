import io

import numpy as np
import pytest

from teachpath.errors import UnusableRecording
from teachpath.io.files import read_tracks
from teachpath.io.import_settings import ImportSettings

CSV = "t,x,y,z\n" + "".join(f"{i * 0.02},{i},{2 * i},0.5\n" for i in range(30))


def read(content: bytes | str, kind: str = "csv", units: str = "m", rate: float = 50.0) -> list[object]:
    raw = content.encode() if isinstance(content, str) else content
    return list(read_tracks(raw, "f", ImportSettings(), kind=kind, units=units, rate=rate))


def npy(values: object) -> bytes:
    out = io.BytesIO()
    np.save(out, values)  # type: ignore[arg-type]
    return out.getvalue()


def test_units_scale_positions_only() -> None:
    (metres,) = read_tracks(CSV.encode(), "f", ImportSettings(), kind="csv", units="m", rate=50.0)
    (inches,) = read_tracks(CSV.encode(), "f", ImportSettings(), kind="csv", units="in", rate=50.0)
    assert np.allclose(inches.positions, metres.positions * 0.0254)
    assert np.array_equal(inches.times, metres.times)


def test_robottasks_makes_one_track_a_demonstration() -> None:
    values = np.zeros((3, 40, 7))
    values[..., 3] = 1.0
    values[..., 0] = np.arange(40)
    tracks = read_tracks(npy(values), "f", ImportSettings(), kind="robottasks", units="cm", rate=100.0)
    assert [len(t.times) for t in tracks] == [40, 40, 40]
    assert tracks[0].positions[-1, 0] == pytest.approx(0.39)
    assert tracks[0].times[-1] == pytest.approx(0.39)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("", "empty"),
        ("t,x,y,z\n", "no samples"),
        ("x,y,z\n1,2,3\n", "first line must be"),
        (CSV + "0.7,1,2\n", "line 32: 3 values"),
        (CSV + "0.7,1,2,x\n", "line 32"),
        (CSV + "0.1,1,2,3\n", "sort by t"),
        (CSV + "0.9,nan,2,3\n", "sample 30 has a x that is not finite"),
        ("t,x,y,z\n0,1,2,3\n", "too few"),
        ("t,x,y,z,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n1,1,2,3,0.5,0,0,0\n", "quaternion of sample 1"),
        (b"\xff\xfe\x00", "not a CSV"),
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
        (npy(np.full((1, 30, 7), np.nan)), "not finite"),
        (npy(np.zeros((2, 30, 7))), "quaternion"),
    ]:
        with pytest.raises(UnusableRecording, match=sentence):
            read(content, kind="robottasks")


@pytest.mark.parametrize(("option", "value"), [("kind", "xls"), ("units", "parsec"), ("rate", 0.0), ("rate", np.nan)])
def test_a_bad_option_names_what_is_known(option: str, value: object) -> None:
    with pytest.raises(UnusableRecording, match=r"known|outside"):
        read(CSV, **{option: value})  # type: ignore[arg-type]
