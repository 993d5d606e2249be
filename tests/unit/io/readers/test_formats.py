"""Formats that other programs write, as small files of each; and tables that leave something open."""

import io
import pickle
import tomllib
from importlib.metadata import EntryPoint
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from scipy.spatial.transform import Rotation

from teachpath.errors import UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import FileMotions, OptionNeeded, Reader, ReadOptions
from teachpath.io.readers.registry import BUILT_IN_READERS, GROUP, read_motions, readers, recognized
from teachpath.records import Array

ROOT = Path(__file__).parents[4]
COUNT = 40
K = np.arange(COUNT)
TIMES = 0.02 * K
POSITIONS = np.column_stack([0.3 + 0.01 * K, -0.2 + 0.002 * K, 0.5 + 0 * K])
TURNS = Rotation.from_rotvec(np.outer(0.02 * K, [0.0, 0.0, 1.0]))
WXYZ, XYZW = TURNS.as_quat(scalar_first=True), TURNS.as_quat()


def text(rows: Array, header: str = "", delimiter: str = ",", form: str = "%.9f") -> bytes:
    out = io.StringIO()
    np.savetxt(out, rows, delimiter=delimiter, header=header, comments="", fmt=form)
    return out.getvalue().encode()


def motive() -> bytes:
    head = (
        "Format Version,1.23,Take Name,Take 1,Export Frame Rate,50,Length Units,Millimeters\n\n"
        ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body Marker\n"
        ",Name,hand,hand,hand,hand,hand,hand,hand,hand:1\n,ID,1,1,1,1,1,1,1,2\n"
        ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Position\n"
        "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,X\n"
    )
    return head.encode() + text(np.column_stack([K, TIMES, XYZW, 1000 * POSITIONS, K]))


def vicon() -> bytes:
    head = "Trajectories\n50\n,,Hand:LWRA,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n"
    return head.encode() + text(np.column_stack([K, 0 * K, 1000 * POSITIONS]), form="%.6f")


def trc() -> bytes:
    head = (
        "PathFileType\t4\t(X/Y/Z)\thand.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n50\t50\t40\t1\tmm\n"
        "Frame#\tTime\thand\t\t\n\t\tX1\tY1\tZ1\n\n"
    )
    rows = [
        f"{k}\t{t:.3f}\t" + "\t".join(f"{c:.4f}" for c in 1000 * p) for k, t, p in zip(K, TIMES, POSITIONS, strict=True)
    ]
    return (head + "\n".join(rows) + "\n").encode()


def npz() -> bytes:
    out = io.BytesIO()
    np.savez(out, t=TIMES, positions=POSITIONS, quaternions=WXYZ)
    return out.getvalue()


ARRAYS = {"t": TIMES, "positions": POSITIONS, "quaternions": WXYZ}


def mat(*, compressed: bool = True, **arrays: object) -> bytes:
    out = io.BytesIO()
    savemat(out, arrays, do_compression=compressed)
    return out.getvalue()


def npy() -> bytes:
    out = io.BytesIO()
    np.save(out, np.column_stack([TIMES, POSITIONS, WXYZ]))
    return out.getvalue()


def matrices() -> bytes:
    poses = np.tile(np.eye(4), (COUNT, 1, 1))
    poses[:, :3, :3], poses[:, :3, 3] = TURNS.as_matrix(), POSITIONS
    return b"\n".join(text(pose, delimiter=" ") for pose in poses)


NS = (1e9 * TIMES + 1403636580e9).astype(np.int64)
EUROC = "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n" + "".join(
    f"{ns},{','.join(f'{v:.9f}' for v in (*p, *q))}\n" for ns, p, q in zip(NS, POSITIONS, WXYZ, strict=True)
)
FILES = {
    "motive": ("take.csv", motive()),
    "vicon": ("take.csv", vicon()),
    "trc": ("take.trc", trc()),
    "euroc": ("data.csv", EUROC.encode()),
    "tum": (
        "groundtruth.txt",
        b"# timestamp tx ty tz qx qy qz qw\n"
        + text(np.column_stack([TIMES + 1305031098.0, POSITIONS, XYZW]), delimiter=" "),
    ),
    "matrices": ("hand.traj", matrices()),
    "npz": ("hand.npz", npz()),
    "npy": ("hand.npy", npy()),
    "mat": ("hand.mat", mat(**ARRAYS)),
    "csv": ("hand.csv", text(np.column_stack([TIMES, POSITIONS, XYZW]), "time,px,py,pz,qx,qy,qz,qw")),
}
UNTURNED_FORMATS = {"vicon", "trc"}  # markers


def read(content: bytes, name: str = "f.csv", **options: object) -> FileMotions:
    return read_motions(content, name, "", ReadOptions(**options), ImportSettings())  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", FILES)
def test_every_format_is_recognized_and_gives_the_same_motion(kind: str) -> None:
    name, content = FILES[kind]
    assert recognized(content, name) == kind
    (track,) = read(content, name).tracks
    assert np.allclose(track.times, TIMES, atol=1e-6)
    assert np.allclose(track.positions, POSITIONS, atol=1e-6)
    if kind in UNTURNED_FORMATS:
        assert track.orientations is None
    else:
        assert track.orientations is not None
        assert np.allclose(np.abs(np.sum(track.orientations * WXYZ, axis=1)), 1.0)


POSES = np.moveaxis(np.tile(np.eye(4), (COUNT, 1, 1)), 0, 2)
POSES[:3, :3, :], POSES[:3, 3, :] = np.moveaxis(TURNS.as_matrix(), 0, 2), POSITIONS.T


@pytest.mark.parametrize(
    "arrays",
    [
        {"t": TIMES[:, None], "positions": POSITIONS.T, "quaternions": WXYZ.T, "subject": "anna"},
        {"time": TIMES, "poses": POSES},
    ],
)
def test_arrays_of_matlab_may_lie_on_their_side(arrays: dict[str, object]) -> None:
    (track,) = read(mat(**arrays), "hand.mat").tracks
    assert np.allclose(track.times, TIMES)
    assert np.allclose(track.positions, POSITIONS)
    assert track.orientations is not None
    assert np.allclose(np.abs(np.sum(track.orientations * WXYZ, axis=1)), 1.0)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (mat(trial={"positions": POSITIONS}), r"no array positions \(n, 3\) in it; it holds trial \(struct\)"),
        (mat(positions="none"), r"it holds positions \(char\)"),
        (b"MATLAB 7.3 MAT-file, made by hand", "not a whole file of format mat"),
        (mat(positions=np.zeros((600_000, 3), np.int8)), "600000 samples, limit 500000"),
        (mat(positions=np.zeros((20_000_000, 3), np.int8)), "expand to 480000000 bytes, limit 268435456"),
    ],
)
def test_a_mat_file_that_cannot_be_read_is_said(content: bytes, sentence: str) -> None:
    with pytest.raises(UnusableRecording, match=sentence):
        read(content, "hand.mat")


PLAIN_TABLE = np.column_stack([TIMES, POSITIONS])
TABLES = {
    "semicolons and decimal commas": (text(PLAIN_TABLE, "t;x;y;z", ";").replace(b".", b","), {}),
    "blanks": (text(PLAIN_TABLE, "t x y z", " "), {}),
    "tabs": (text(PLAIN_TABLE, "t\tx\ty\tz", "\t"), {}),
    "spaces behind commas": (text(PLAIN_TABLE, "t, x, y, z", ", "), {}),
    "a comma behind each row": (text(PLAIN_TABLE, "t,x,y,z").replace(b"\n", b",\n"), {}),
    "a comment": (b"# my tracker\n" + text(PLAIN_TABLE, "t,x,y,z"), {}),
    "capitals": (text(PLAIN_TABLE, "T,X,Y,Z"), {}),
    "no header": (text(PLAIN_TABLE), {"columns": "t=1,x=2,y=3,z=4"}),
    "other names": (
        text(PLAIN_TABLE[:, [1, 0, 2, 3]], "Position.X,Zeit,b,c"),
        {"columns": "t=Zeit,x=Position.X,y=3,z=c"},
    ),
    "milliseconds by name": (text(PLAIN_TABLE * [1000, 1, 1, 1], "t_ms,x,y,z"), {}),
    "milliseconds as said": (text(PLAIN_TABLE * [1000, 1, 1, 1], "t,x,y,z"), {"time_unit": "ms"}),
    "millimetres by name": (text(PLAIN_TABLE * [1, 1000, 1000, 1000], "t,x [mm],y [mm],z [mm]"), {}),
    "millimetres as said": (text(PLAIN_TABLE * [1, 1000, 1000, 1000], "t,x,y,z"), {"units": "mm"}),
}


@pytest.mark.parametrize("what", TABLES)
def test_tables_of_every_kind_give_the_same_motion(what: str) -> None:
    content, options = TABLES[what]
    (track,) = read(content, **options).tracks
    assert np.allclose(track.times, TIMES, atol=1e-6)
    assert np.allclose(track.positions, POSITIONS, atol=1e-6)


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (text(PLAIN_TABLE * [1e3, 1, 1, 1], "t,x,y,z"), "t looks like ms: .* --time ms"),
        (text(PLAIN_TABLE * [1e6, 1, 1, 1], "t,x,y,z"), "t looks like us: .* --time us"),
        (text(PLAIN_TABLE * [1e9, 1, 1, 1], "t,x,y,z"), "t looks like ns: .* --time ns"),
        (text(PLAIN_TABLE * [1, 1e3, 1e3, 1e3], "t,x,y,z"), r"spans 390 m, limit 10; .*--units .*mm \(0\.39 m\)"),
        (text(PLAIN_TABLE), "no column for t, x, y, z; .*--columns t=1"),
        (text(np.column_stack([PLAIN_TABLE, TIMES]), "t,x,y,z,time"), "t and time could all be t; .*--columns t=..."),
        (text(np.column_stack([PLAIN_TABLE, XYZW[:, :2]]), "t,x,y,z,qx,qy"), "no column for qw, qz"),
        (text(np.column_stack([TIMES, POSITIONS, POSITIONS, K]), "t,x,y,z,qx,qy,qz,qw"), "has length"),
        (motive().replace(b"hand,hand,hand,hand,hand,hand,hand,hand:1", b"a,a,a,a,a,a,a,b"), None),
    ],
)
def test_what_a_file_leaves_open_is_said_with_the_way_out(content: bytes, sentence: str | None) -> None:
    if sentence is None:
        assert len(read(content).tracks) == 1  # a marker without rotation is no second body
        return
    with pytest.raises(UnusableRecording, match=sentence):
        read(content)


def test_a_question_comes_back_whole_from_the_process_that_reads() -> None:
    error = OptionNeeded("t looks like ms or us", "time", "ms", "us")
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error) == "t looks like ms or us; say its unit with --time ms or us"
    assert again.question == error.question


def test_one_of_several_is_chosen_by_its_name() -> None:
    two = trc().replace(b"hand\t\t\n", b"hand\t\t\telbow\t\t\n").replace(b"X1\tY1\tZ1", b"X1\tY1\tZ1\tX2\tY2\tZ2")
    head, _, rows = two.partition(b"Z2\n\n")
    two = head + b"Z2\n\n" + b"".join(line + b"\t1\t2\t3\n" for line in rows.splitlines())
    with pytest.raises(UnusableRecording, match=r"holds 2 of them; choose one with --track hand or elbow"):
        read(two, "f.trc")
    chosen = read(two, "f.trc", track="hand")
    assert np.allclose(chosen.tracks[0].positions, POSITIONS, atol=1e-6)
    assert chosen.choices == ("hand", "elbow")
    assert read(trc(), "f.trc").choices == ()


def test_what_was_understood_is_told() -> None:
    told = "; ".join(read(text(np.column_stack([PLAIN_TABLE, K]), "t,x,y,z,temperature")).understood)
    assert "time in s (t); position in m (x, y, z); no orientation; not read: temperature" in told


def test_all_readers_of_the_house_are_members_of_the_group() -> None:
    assert set(readers()) >= {reader.name for reader in BUILT_IN_READERS}
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"][GROUP]
    loaded = {name: EntryPoint(name, value, GROUP).load() for name, value in declared.items()}
    assert loaded == {reader.name: reader for reader in BUILT_IN_READERS}
    assert all(isinstance(reader, Reader) and reader.title for reader in readers().values())
