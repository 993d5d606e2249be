"""The settings: deploy/teachpath.toml is the defaults, and every wrong setting is refused with its name."""

import ast
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any

import pytest

from teachpath import config
from teachpath.config import Settings, load
from teachpath.errors import UnusableInput, UnusableSettings
from tests.contract import settings_file
from tests.waiting import HANG

ROOMS = [(room, type(getattr(Settings(), room))) for room in Settings.model_fields]
ROOMS = [(room, kind) for room, kind in ROOMS if is_dataclass(kind)]


@contextmanager
def variables(**given: str) -> Iterator[None]:
    """Set variables for a while, and none of teachpath's else."""
    before = {name: os.environ.pop(name) for name in list(os.environ) if name.startswith("TEACHPATH_")}
    os.environ.update(given)
    try:
        yield
    finally:
        for name in given:
            os.environ.pop(name, None)
        os.environ.update(before)


@pytest.fixture(autouse=True)
def _alone() -> Iterator[None]:
    with variables():
        yield


def toml(tmp_path: Path, text: str) -> Path:
    file = tmp_path / "station.toml"
    file.write_text(text)
    return file


def test_the_annotated_file_is_written_from_the_source() -> None:
    assert settings_file.FILE.read_text() == settings_file.text(), "run: python -m tests.contract.settings_file"


def test_every_settings_class_of_the_service_is_in_the_tree() -> None:
    service = Path(config.__file__).parent
    found = {
        node.name
        for file in service.rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.ClassDef) and node.name.endswith("Settings") and "UnusableInput" not in ast.dump(node)
    }
    assert found == {kind.__name__ for _, kind in ROOMS} | {"Settings"}


def test_the_annotated_file_is_the_defaults() -> None:
    assert load(settings_file.FILE) == Settings()


@pytest.mark.parametrize(("room", "kind"), ROOMS)
def test_the_annotated_file_holds_every_setting_and_explains_it(room: str, kind: Any) -> None:
    section = settings_file.FILE.read_text().split(f"\n[{room}]\n")[1].split("\n\n")[0]
    pairs = re.findall(r"^# (.{8,})\n((?:# )?)(\w+) = ", section, re.MULTILINE)
    default = getattr(Settings(), room)
    assert [name for _, _, name in pairs] == [field.name for field in fields(kind)]
    assert [name for _, hidden, name in pairs if hidden] == [
        f.name for f in fields(kind) if getattr(default, f.name) is None
    ]


def test_settings_without_a_default_are_usable_as_shown(tmp_path: Path) -> None:
    shown = re.sub(r"^# (\w+ = )", r"\1", settings_file.FILE.read_text(), flags=re.MULTILINE)
    assert load(toml(tmp_path, shown)).learning.threshold == settings_file.EXAMPLES["learning.threshold"]


def test_the_command_line_wins_over_variables_over_the_file_over_the_defaults(tmp_path: Path) -> None:
    file = toml(tmp_path, '[web]\nport = 1\nhost = "file"\nhosts = ["file"]\nlargest_upload = 5000\n')
    with variables(TEACHPATH_WEB__PORT="2", TEACHPATH_WEB__HOST="variable"):
        web = load(file, document={"web": {"port": 3}}).web
    assert (web.port, web.host, web.hosts, web.largest_upload) == (3, "variable", ("file",), 5000)
    assert load(file).recording == Settings().recording


def test_the_file_is_found_by_option_then_by_variable(tmp_path: Path) -> None:
    named = toml(tmp_path, "[web]\nport = 1\n")
    other = tmp_path / "other.toml"
    other.write_text("[web]\nport = 2\n")
    with variables(TEACHPATH_CONFIG=str(other)):
        assert load(named).web.port == 1
        assert load().web.port == 2


@pytest.mark.parametrize(
    ("variable", "text", "place", "value"),
    [
        ("TEACHPATH_WEB__PORT", "9000", "web.port", 9000),
        ("TEACHPATH_LEARNING__THRESHOLD", "0.06", "learning.threshold", 0.06),
        ("TEACHPATH_EXECUTOR__REALTIME", "false", "executor.realtime", False),
        ("TEACHPATH_STORE__DATA_DIR", "/data 1", "store.data_dir", "/data 1"),
        ("TEACHPATH_STORE__DATA_DIR", "12", "store.data_dir", "12"),
        ("TEACHPATH_WEB__HOSTS", '["a", "b"]', "web.hosts", ("a", "b")),
        ("TEACHPATH_MOTION__HOME", "[0, 1, 2, 3, 4, 5]", "motion.home", (0, 1, 2, 3, 4, 5)),
        ("TEACHPATH_WEB__PORT", "", "web.port", 8765),
        ("TEACHPATH_PORT_8765_TCP", "tcp://10.0.0.1:8765", "web.port", 8765),
    ],
)
def test_a_variable_is_read_by_the_type_of_its_setting(variable: str, text: str, place: str, value: Any) -> None:
    with variables(**{variable: text}):
        assert attrgetter(place)(load()) == value


BODY = "[[scenes]]\nname = 'a'\n[scenes.carried]\nname = 'b'\nsize = [1.0]\nposition = [0, 0, 0]\n"
WRONG_SETTINGS = {
    "[webb]\nport = 1": "there is no setting webb; known here: bus, web",
    "[web]\nprot = 1": "there is no setting web.prot; known here: host, port",
    "[learning]\nguard = 0.5": "setting learning.guard was replaced by learning.min_separation",
    "[bus]\nrouter = true": "setting bus.router was replaced by bus.mode",
    "[learning]\ninconsistent = 3.0": "setting learning.inconsistent was replaced by learning.outlier_limit",
    "[motion]\ngrasp_tolerance = 0.03": "setting motion.grasp_tolerance was replaced by motion.grasp_depth",
    "[simulator]\nreach = 0.03": "setting simulator.reach was replaced by motion.grasp_depth",
    "[simulator]\nsilence = 0.02": "setting simulator.silence is gone, and none takes its place; leave it out",
    "[learning]\nperiod = 0.02": "setting learning.period is gone, and none takes its place; leave it out",
    "[[calibrations]]\nname = 'a'\nscales = 2": "no setting calibrations.0.scales; known here: name, scale",
    "[[scenes]]\nname = 'a'\n[scenes.carried]\nweight = 2": "no setting scenes.0.carried.weight",
    "[web]\nport = 'many'": "setting web.port is 'many'; it should be a valid integer",
    "[web]\nport = true": "setting web.port is True",
    "[web]\nhosts = 'a'": "setting web.hosts is 'a'; it should be a valid array",
    "[web]\nport = 1979-05-27": "setting web.port is '1979-05-27'",
    f"[learning]\nseed = 1{400 * '0'}": "a number is too large",
    "web = 3": "setting web is 3; it should be an object",
    "[web]\nport = 0": "setting web.port is 0; it should be greater than or equal to 1",
    "[recording]\nclose_at = nan": "setting recording.close_at is nan; it should be a finite number",
    "[motion]\nleast_singular = inf": "setting motion.least_singular is inf",
    "[motion]\nhome = [0.0, 1.0]": "setting motion.home",
    "[learning]\nmode = 'other'": "learning.mode is 'other'; it should be 'default', 'paper' or 'repaired'",
    "[learning]\nmode = 'paper'": "set learning.threshold",
    "[[calibrations]]\nscale = 2.0": "setting calibrations.0.name is",
    "[[calibrations]]\nname = 'a'\n[[calibrations]]\nname = 'a'": "two settings of the calibration a",
    "[[calibrations]]\nname = 'a/b'": "'a/b' cannot name a calibration",
    "[[calibrations]]\nname = 'a'\nscale = 0.0": "calibration a has a scale of 0",
    "[[calibrations]]\nname = 'a'\nrotation = [1.0, 1.0, 0.0, 0.0]": "calibration a has a rotation of length 1.41421",
    "[[scenes]]\nname = 'a'\n[[scenes]]\nname = 'a'": "two settings of the scene a",
    "[bus]\nrobot = 'a b'": "'a b' cannot name a robot",
    "scenes = []": "at least one scene",
    f"{BODY}kind = 'ball'": "scenes.0.carried.kind is 'ball'; it should be 'box', 'cylinder'",
    f"{BODY}kind = 'box'": "a box has 3 lengths over 0",
    "[web\nport = 1": "is not TOML: .*line 1",
}


@pytest.mark.parametrize("text", WRONG_SETTINGS)
def test_a_wrong_file_is_one_sentence_that_names_the_setting(tmp_path: Path, text: str) -> None:
    with pytest.raises(UnusableSettings, match=WRONG_SETTINGS[text]) as caught:
        load(toml(tmp_path, text))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("variable", "text", "sentence"),
    [
        ("TEACHPATH_WEB__PROT", "1", "no setting web.prot"),
        ("TEACHPATH_WEBB__PORT", "1", "no setting webb"),
        ("TEACHPATH_WEB__PORT", "many", "setting web.port is 'many'"),
        ("TEACHPATH_WEB__PORT", "65536", "setting web.port is 65536; it should be less than or equal to 65535"),
        ("TEACHPATH_MOTION__HOME", "0, 1", "setting motion.home is '0, 1'; it should be a valid array"),
        ("TEACHPATH_CONFIG", "nowhere.toml", "cannot read the settings file nowhere.toml: No such file"),
    ],
)
def test_a_wrong_variable_is_one_sentence_that_names_the_setting(variable: str, text: str, sentence: str) -> None:
    with variables(**{variable: text}), pytest.raises(UnusableSettings, match=sentence):
        load()


def test_a_missing_file_and_one_that_is_no_text_are_sentences(tmp_path: Path) -> None:
    with pytest.raises(UnusableSettings, match=r"cannot read the settings file .*missing\.toml: No such file"):
        load(tmp_path / "missing.toml")
    binary = tmp_path / "binary.toml"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(UnusableSettings, match="is not TOML"):
        load(binary)


def test_settings_reach_another_process_whole(tmp_path: Path) -> None:
    settings = load(toml(tmp_path, "[web]\nport = 1\n[learning]\nthreshold = 0.06\n"))
    with variables(TEACHPATH_WEB__PORT="2"):
        assert load(document=json.loads(settings.model_dump_json())) == settings


def test_the_command_line_ends_with_the_sentence(tmp_path: Path) -> None:
    file = toml(tmp_path, "[web]\nprot = 1\n")
    ended = subprocess.run(
        [sys.executable, "-m", "teachpath", "serve", "--config", str(file)],
        capture_output=True,
        text=True,
        timeout=HANG,
    )
    assert (ended.returncode, ended.stderr) == (
        1,
        "teachpath: there is no setting web.prot; known here: host, port, display_name, hosts, tls, proxies, "
        "largest_upload, request_timeout, max_connections\n",
    )


ZONE = "scenes = [{name = 's', floor = -0.2, %s = [{name = 'z', kind = '%s', size = %s, position = [0, 0, 1]}]}]\n"


def test_a_scene_has_a_floor_and_zones_and_one_without_has_a_floor_at_the_arms_foot(tmp_path: Path) -> None:
    (scene,) = load(toml(tmp_path, "[[scenes]]\nname = 'old'\n")).scenes
    assert (scene.floor, scene.keep_in, scene.keep_out) == (0.0, (), ())
    (scene,) = load(toml(tmp_path, ZONE % ("keep_out", "cylinder", "[0.1, 2.0]"))).scenes
    assert (scene.floor, scene.keep_out[0].size) == (-0.2, (0.1, 2.0))
    for zone, sentence in (
        (("keep_in", "cylinder", "[0.1, 2.0]"), "keep-in zone z in scene s is a cylinder; use a box"),
        (("keep_out", "box", "[0.1, 2.0]"), r"z in scene s has size \(0.1, 2.0\); a box has 3 lengths over 0"),
        (("keep_off", "box", "[1, 1, 1]"), "there is no setting scenes.0.keep_off; known here: name, obstacles, "),
    ):
        with pytest.raises(UnusableSettings, match=sentence):
            load(toml(tmp_path, ZONE % zone))


def test_a_mesh_is_read_beside_the_settings_and_a_wrong_shape_is_named(tmp_path: Path) -> None:
    (tmp_path / "cube.obj").write_text("".join(f"v {x} {y} {z}\n" for x in (0, 9) for y in (0, 9) for z in (0, 9)))
    shape = 'scenes = [{name = "s", obstacles = [{name = "cube", kind = "mesh", size = [0.001], position = [0, 0, 0]'
    settings = load(toml(tmp_path, f'{shape}, file = "cube.obj"}}]}}]\n'))
    (cube,) = settings.scenes[0].obstacles
    assert len(set(cube.vertices)) == 8
    handed_on = load(document=settings.model_dump(mode="json"))
    assert handed_on.scenes == settings.scenes
    for wrong, sentence in (
        ("}]}]\n", "cube in scene s is a mesh; a mesh, and only a mesh, has a file"),
        (', file = "none.obj"}]}]\n', "No such file"),
        (', file = "cube.obj", orientation = [1, 1, 0, 0]}]}]\n', "has an orientation of length 1.41421"),
    ):
        with pytest.raises(UnusableInput, match=sentence):
            load(toml(tmp_path, shape + wrong))
