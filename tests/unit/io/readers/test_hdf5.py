"""HDF5 and C3D, as the libraries that others use write them: robomimic's layout, MATLAB's, and markers."""

import io
import json
import warnings
from pathlib import Path
from typing import Any

import c3d
import h5py
import numpy as np
import pytest

from teachpath.errors import UnusableInput, UnusableRecording
from teachpath.io.import_settings import ImportSettings
from teachpath.io.readers.contract import FileMotions, ReadOptions, Track
from teachpath.io.readers.registry import read_motions, reads_from_disk, recognized
from tests.unit.io.readers.test_damage import damaged
from tests.unit.io.readers.test_formats import ARRAYS, COUNT, POSITIONS, TIMES, WXYZ, XYZW, text

GRIPPER_COLUMN = np.where(np.arange(COUNT) < 10, -1.0, 1.0)


def read(content: bytes, name: str = "demo.hdf5", **options: Any) -> FileMotions:
    return read_motions(content, name, "", ReadOptions(**options), ImportSettings())


def seen(track: Track) -> Any:
    return slice(None) if track.tracked is None else track.tracked


def hdf5(fill: Any, **options: Any) -> bytes:
    out = io.BytesIO()
    with h5py.File(out, "w", **options) as file:
        fill(file)
    return out.getvalue()


def robomimic(arms: int = 1, *, width: int = 7, numbers: tuple[int, ...] = (0, 1), frequency: Any = 50) -> bytes:
    """Return demonstrations as robomimic lays them out; each begins 0.1 m further than the one before."""

    def fill(file: h5py.File) -> None:
        data = file.create_group("data")
        data.attrs["env_args"] = json.dumps({"env_name": "Lift", "env_kwargs": {"control_freq": frequency}})
        for number in numbers:
            demonstration = data.create_group(f"demo_{number}")
            actions = np.zeros((COUNT, width * arms))
            actions[:, width - 1 :: width] = GRIPPER_COLUMN[:, None]
            demonstration.create_dataset("actions", data=actions, compression="gzip")
            for arm in range(arms):
                name = f"obs/robot{arm}_"
                demonstration[f"{name}eef_pos"] = POSITIONS + 0.1 * number + arm
                demonstration.create_dataset(f"{name}eef_quat", data=XYZW, chunks=(8, 4), compression="gzip")
                demonstration[f"{name}gripper_qpos"] = np.zeros((COUNT, 2))

    return hdf5(fill)


def test_demonstrations_of_robomimic_are_motions_with_their_grasp() -> None:
    content = robomimic(numbers=(0, 2, 10))  # by their numbers, though HDF5 lists demo_10 before demo_2
    assert recognized(content, "demo.hdf5") == "hdf5"
    found = read(content)
    assert "3 demonstrations of robomimic" in found.understood
    assert "50 Hz, by its env_args" in found.understood
    for number, track in zip((0, 2, 10), found.tracks, strict=True):
        assert np.allclose(track.times, TIMES)
        assert np.allclose(track.positions, POSITIONS + 0.1 * number)
        assert track.orientations is not None
        assert np.allclose(track.orientations, WXYZ)
        assert track.closure is not None
        assert np.array_equal(track.closure > 0.5, GRIPPER_COLUMN > 0.0)


def test_a_file_of_any_size_is_read_where_it_lies(tmp_path: Path) -> None:
    file, shares = tmp_path / "demo.hdf5", list[float]()
    file.write_bytes(robomimic())
    with h5py.File(file, "a") as large:  # pictures, which are not read
        large.create_dataset("data/demo_0/obs/agentview_image", (COUNT, 2000, 2000, 3), "u1")
    beginning = file.read_bytes()[:1000]
    assert reads_from_disk("", beginning, file.name)
    options, limits = ReadOptions(), ImportSettings()
    found = read_motions(beginning, file.name, "", options, limits, file=file, progress=shares.append)
    assert np.allclose(found.tracks[0].positions, POSITIONS)
    assert shares == [0.0]


def test_one_of_two_arms_is_chosen() -> None:
    content = robomimic(arms=2)
    with pytest.raises(UnusableRecording, match="it holds 2 arms; choose one with --track robot0 or robot1"):
        read(content)
    found = read(content, track="robot1", rate=100.0)
    assert found.choices == ("robot0", "robot1")
    assert np.allclose(found.tracks[0].positions, POSITIONS + 1.0)
    assert found.tracks[0].times[1] == pytest.approx(0.01)


def test_actions_of_another_width_tell_no_grasp_and_a_frequency_that_is_none_no_clock() -> None:
    found = read(robomimic(width=4, frequency="fast"))
    assert found.tracks[0].closure is None
    assert "50 Hz, it has no clock" in found.understood


@pytest.mark.parametrize("options", [{}, {"userblock_size": 512}])
def test_named_arrays_are_read_as_in_npz_also_those_of_matlab_7_3(options: dict[str, Any]) -> None:
    def fill(file: h5py.File) -> None:
        for key, array in ARRAYS.items():
            file[key] = array.T if options else array  # MATLAB's first axis is the last one here
        file["note"] = "Anna"

    content = hdf5(fill, **options)
    if options:
        content = b"MATLAB 7.3 MAT-file, by hand".ljust(512) + content[512:]
    assert recognized(content, "f") == ("mat" if options else "hdf5")
    (track,) = read(content).tracks
    assert np.allclose(track.times, TIMES)
    assert np.allclose(track.positions, POSITIONS)
    assert track.orientations is not None
    assert np.allclose(track.orientations, WXYZ)


def filled(**arrays: Any) -> bytes:
    return hdf5(lambda file: [file.create_dataset(name.replace("__", "/"), **each) for name, each in arrays.items()])


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        (filled(qpos={"data": POSITIONS}), r"neither demonstrations of robomimic .* it holds qpos"),
        (
            filled(data__episode_0={"data": POSITIONS}),
            r"no demonstration data/demo_0 in it; data holds \['episode_0'\]",
        ),
        (filled(data__demo_0__obs__qpos={"data": POSITIONS}), "no position of a hand .* joints alone are not read"),
        (filled(data__demo_0__obs__r_eef_pos={"data": XYZW}), r"r_eef_pos is float64 \(40, 4\); it must be numbers"),
        (filled(data__demo_0__obs__r_eef_pos={"shape": (600_000, 3), "dtype": "f4"}), "600000 samples, limit 500000"),
        (filled(positions={"shape": (40_000_000, 3), "dtype": "f4"}), "limit 268435456"),
        (robomimic()[:20_000], "not a whole file of format hdf5"),
        (b"\x89HDF\r\n\x1a\n", "not a whole file of format hdf5"),
    ],
)
def test_what_cannot_be_read_is_said(content: bytes, sentence: str) -> None:
    with pytest.raises(UnusableRecording, match=sentence):
        read(content)


@pytest.mark.parametrize("way", ["soft", "external", "raw", "virtual"])
def test_a_file_that_refers_to_another_one_is_refused(tmp_path: Path, way: str) -> None:
    secret = tmp_path / "secret.h5"
    secret.write_bytes(filled(positions={"data": POSITIONS}))

    def fill(file: h5py.File) -> None:
        file["t"], file["p"] = TIMES, POSITIONS
        if way == "soft":
            file["positions"] = h5py.SoftLink("/p")
        elif way == "external":
            file["positions"] = h5py.ExternalLink(str(secret), "/positions")
        elif way == "raw":
            file.create_dataset("positions", (COUNT, 3), "f8", external=[(str(secret), 0, h5py.h5f.UNLIMITED)])
        else:
            layout = h5py.VirtualLayout((COUNT, 3), "f8")
            layout[:] = h5py.VirtualSource(str(secret), "positions", (COUNT, 3))
            file.create_virtual_dataset("positions", layout)

    with pytest.raises(UnusableRecording, match=r"link to another place|lies in another file"):
        read(hdf5(fill))


def markers(labels: list[str], *, untracked: tuple[int, ...] = (), units: str = "mm") -> bytes:
    """Return a C3D file; each marker lies 1 m beside the one before."""
    writer = c3d.Writer(point_rate=50.0, point_units=units)
    writer.set_point_labels(labels)
    scale = 1000.0 if units == "mm" else 1.0
    for k in range(COUNT):
        points = np.zeros((len(labels), 5), np.float32)
        for m in range(len(labels)):
            points[m, :3] = scale * (POSITIONS[k] + m * np.eye(3)[0])
            points[m, 3:] = -1.0 if k in untracked else 0.0
        writer.add_frames([(points, np.zeros((0, 1)))])
    out = io.BytesIO()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that there is nothing analog in it
        writer.write(out)
    return out.getvalue()


def test_a_marker_of_a_c3d_file_is_a_motion() -> None:
    content = markers(["LWRA"], untracked=(3, 4))
    assert recognized(content, "take.c3d") == "c3d"
    (track,) = read(content, "take.c3d").tracks
    assert track.tracked is not None
    assert np.flatnonzero(~track.tracked).tolist() == [3, 4]
    assert np.allclose(track.times, TIMES)
    assert np.allclose(track.positions[track.tracked], POSITIONS[track.tracked], atol=1e-5)


def test_one_of_several_markers_is_chosen() -> None:
    content = markers(["LWRA", "RWRA"], units="m")
    with pytest.raises(UnusableRecording, match="it holds 2 markers; choose one with --track LWRA or RWRA"):
        read(content, "take.c3d")
    (track,) = read(content, "take.c3d", track="RWRA").tracks
    assert np.allclose(track.positions, POSITIONS + np.eye(3)[0], atol=1e-5)


def test_a_c3d_file_that_is_cut_off_is_said() -> None:
    with pytest.raises(UnusableRecording, match=r"it is cut off: \d+ of 40 frames are in it|not a whole file"):
        read(markers(["LWRA"])[:-512], "take.c3d")


def test_damaged_files_end_in_a_sentence_or_in_a_motion() -> None:
    for kind, name, content in (("hdf5", "demo.hdf5", robomimic()), ("c3d", "take.c3d", markers(["LWRA"]))):
        said = []
        for number in range(60):
            broken = damaged(content, np.random.default_rng(number))
            try:
                found = read_motions(broken, name, kind, ReadOptions(), ImportSettings())
                assert all(np.isfinite(track.positions[seen(track)]).all() for track in found.tracks)
            except UnusableInput as error:
                said.append(str(error))
        assert said
        assert all(name in sentence for sentence in said)


def test_poses_of_arkit_are_read_by_the_name_of_their_file() -> None:
    content = text(np.column_stack([TIMES + 5000.0, POSITIONS, WXYZ]))
    assert recognized(content, "ARposes.txt".lower()) == "arkit"
    (track,) = read(content, "ARposes.txt").tracks
    assert np.allclose(track.positions, POSITIONS)
    assert track.orientations is not None
    assert np.allclose(track.orientations, WXYZ)
