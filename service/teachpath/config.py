"""The settings of every room in one frozen tree: defaults, one TOML file, then TEACHPATH_* variables.

A variable names its room and setting: `TEACHPATH_WEB__PORT=9000`; lists are written as in TOML.
"""

from __future__ import annotations

import json
import math
import os
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import asdict, is_dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, get_args, get_type_hints

from pydantic import BaseModel, ConfigDict, PrivateAttr, ValidationError

from teachpath.access.settings import AuthSettings, LimitSettings, OidcSettings, ProxySettings
from teachpath.errors import UnusableInput, UnusableSettings
from teachpath.executor.settings import ExecutorSettings
from teachpath.executor.teleop.settings import TeleoperationSettings
from teachpath.io.bus_settings import BusSettings
from teachpath.io.import_settings import ImportSettings
from teachpath.io.meshes import read_mesh
from teachpath.io.store.object_storage import check_url
from teachpath.io.store.settings import StoreSettings
from teachpath.jobs.settings import JobSettings, check_executor
from teachpath.learning.settings import LearningSettings
from teachpath.live.preview.settings import PreviewSettings
from teachpath.logs import LogSettings
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.mounting import check_mounting
from teachpath.motion.collision.builtin_scenes import empty_scene, paper_scene
from teachpath.motion.collision.scene_checks import check_scene
from teachpath.motion.planning.model_arms import check_home_size, with_home
from teachpath.motion.settings import MotionSettings
from teachpath.recording.settings import RecordingSettings
from teachpath.records import Calibration, Scene, SerialArm, Shape
from teachpath.simulator.settings import SimulatorSettings
from teachpath.web.settings import WebSettings
from teachpath_proto.display_names import checked_display_name
from teachpath_proto.keys import is_name, name_refusal

PREFIX = "TEACHPATH_"
# former settings -> the one that does their work; empty: none does
REPLACED_SETTINGS = {
    **dict.fromkeys(("learning.guard", "learning.min_silhouette"), "learning.min_separation"),
    "learning.inconsistent": "learning.outlier_limit",
    **dict.fromkeys(("motion.grasp_tolerance", "simulator.reach"), "motion.grasp_depth"),
    **dict.fromkeys(("learning.period", "simulator.silence"), ""),
    "bus.router": "bus.mode",
}
# RoboTasks (clfd datasets) was recorded in the frame of another arm; this maps it, shrunk, onto the Puma's table.
ROBOTTASKS = Calibration("robottasks", scale=0.8, rotation=(1.0, 0.0, 0.0, 0.0), offset=(0.15, 0.17, 0.42))


class Settings(BaseModel):
    """Every setting of a station."""

    model_config: ClassVar[ConfigDict] = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    bus: BusSettings = BusSettings()
    web: WebSettings = WebSettings()
    auth: AuthSettings = AuthSettings()
    oidc: OidcSettings = OidcSettings()
    proxy: ProxySettings = ProxySettings()
    limits: LimitSettings = LimitSettings()
    store: StoreSettings = StoreSettings()
    imports: ImportSettings = ImportSettings()
    recording: RecordingSettings = RecordingSettings()
    learning: LearningSettings = LearningSettings()
    motion: MotionSettings = MotionSettings()
    executor: ExecutorSettings = ExecutorSettings()
    teleoperation: TeleoperationSettings = TeleoperationSettings()
    simulator: SimulatorSettings = SimulatorSettings()
    jobs: JobSettings = JobSettings()
    preview: PreviewSettings = PreviewSettings()
    log: LogSettings = LogSettings()
    calibrations: tuple[Calibration, ...] = (Calibration("identity"), ROBOTTASKS)
    scenes: tuple[Scene, ...] = (paper_scene(), empty_scene())

    _model: SerialArm | None = PrivateAttr(default=None)

    @property
    def arm(self) -> Arm:
        """The arm that they describe: the published variant `motion.variant`, or the model of `with_model`."""
        return Arm.of_model(self._model, self.motion) if self._model else Arm.of_settings(self.motion)

    @property
    def model(self) -> SerialArm | None:
        """Model of the arm that `motion.arm` names, as the data folder has it; None: none was read."""
        return self._model

    def with_model(self, model: SerialArm) -> Settings:
        """Return the settings with the model of the arm that `motion.arm` names, and its home where they say none."""
        home = with_home(self.motion, Arm.of_model(model, self.motion))
        made = self.model_copy(update={"motion": home})
        made._model = model
        return made

    def learning_with(self, changes: Mapping[str, Any]) -> LearningSettings:
        """Return the settings of learning with `changes` laid over them; raises UnusableSettings."""
        _refuse_unknown(changes, LearningSettings, "learning.")
        return _checked({"learning": asdict(self.learning) | dict(changes)}).learning


def load(file: Path | None = None, *, document: dict[str, Any] | None = None) -> Settings:
    """Read the settings: `document` wins over TEACHPATH_* variables, those over the file, that over the defaults.

    Args:
        file: TOML file; else TEACHPATH_CONFIG, else ./teachpath.toml when it exists.
        document: settings given on the command line.

    Raises:
        UnusableSettings: a setting that does not exist, is of the wrong type or outside its limits; the sentence names
            it. A variable without `__` in its name is no setting of ours and is passed over.
    """
    given: dict[str, Any] = {}
    for layer in (_read(file), _variables(), document or {}):
        _refuse_unknown(layer, Settings, "")
        given = _laid_over(given, layer)
    settings = _with_meshes(_checked(given), _folder(file))
    if settings.motion.arm is None:
        check_mounting(settings.arm)
        check_home_size(settings.motion, settings.arm)
    _check_names("robot", [settings.bus.robot])
    if settings.store.station:
        _check_names("station", [settings.store.station])
    try:
        checked_display_name(settings.web.display_name)
    except ValueError as error:
        raise UnusableSettings(f"web.display_name: {error}") from None
    if settings.store.recordings:
        check_url(settings.store.recordings)
    check_executor(settings.jobs.executor)
    _check_calibrations(settings.calibrations)
    _check_scenes(settings.scenes)
    return settings


def _checked(document: dict[str, Any]) -> Settings:
    try:
        # JSON is where a strict check still takes a list for a tuple and an object for a dataclass.
        return Settings.model_validate_json(json.dumps(document, default=str), strict=True)
    except ValidationError as error:
        first = error.errors()[0]
        if not first["loc"]:
            raise UnusableSettings(f"the settings cannot be read: {first['msg']}") from None
        place = ".".join(str(p) for p in first["loc"])
        fault = first["msg"].replace("Input should", "it should")
        raise UnusableSettings(f"setting {place} is {first.get('input')!r}; {fault}") from None
    except OverflowError:
        raise UnusableSettings("a number is too large for any setting; look for one of over 300 digits") from None


def _named_file(file: Path | None) -> Path | None:
    return file or (Path(os.environ["TEACHPATH_CONFIG"]) if os.environ.get("TEACHPATH_CONFIG") else None)


def _folder(file: Path | None) -> Path:
    return (_named_file(file) or Path("teachpath.toml")).parent


def _with_meshes(settings: Settings, folder: Path) -> Settings:
    """Read the files of meshes; settings that a process hands to another have their vertices already."""

    def read(shape: Shape) -> Shape:
        if not shape.file or shape.vertices:
            return shape
        mesh = read_mesh(folder / shape.file, max_pieces=shape.max_pieces)
        return replace(shape, vertices=mesh.vertices, pieces=mesh.pieces)

    scenes = tuple(
        replace(
            scene,
            obstacles=tuple(map(read, scene.obstacles)),
            carried=scene.carried and read(scene.carried),
            keep_in=tuple(map(read, scene.keep_in)),
            keep_out=tuple(map(read, scene.keep_out)),
        )
        for scene in settings.scenes
    )
    return settings.model_copy(update={"scenes": scenes})


def _read(file: Path | None) -> dict[str, Any]:
    named = _named_file(file)
    chosen = named or Path("teachpath.toml")
    if named is None and not chosen.is_file():
        return {}
    try:
        return tomllib.loads(chosen.read_text())
    except OSError as error:
        raise UnusableSettings(f"cannot read the settings file {chosen}: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UnusableSettings(f"the settings file {chosen} is not TOML: {error}") from None


def _variables() -> dict[str, Any]:
    """Return the settings that are given as variables; an empty one counts as not given."""
    document: dict[str, Any] = {}
    kinds = _kinds(Settings)
    for variable, text in os.environ.items():
        room, mark, setting = variable.removeprefix(PREFIX).lower().partition("__")
        if variable.startswith(PREFIX) and mark and text:
            document.setdefault(room, {})[setting] = _value(text, _kinds(kinds.get(room)).get(setting))
    return document


def _value(text: str, kind: Any) -> Any:
    if kind is str:
        return text
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _laid_over(below: Any, above: Any) -> Any:
    if not (isinstance(below, dict) and isinstance(above, dict)):
        return above
    return below | {key: _laid_over(below.get(key), value) for key, value in above.items()}


def _kinds(kind: Any) -> Mapping[str, Any]:
    """Return the settings of a room, or the fields of a record, with their types; of anything else none."""
    if kind is Settings:
        return {name: field.annotation for name, field in Settings.model_fields.items()}
    return get_type_hints(kind) if is_dataclass(kind) and isinstance(kind, type) else {}


def _refuse_unknown(document: Any, kind: Any, place: str) -> None:
    """Name a setting that does not exist, and what does exist there."""
    if isinstance(document, list):
        for number, entry in enumerate(document):
            _refuse_unknown(entry, kind, f"{place}{number}.")
        return
    known = _kinds(kind)
    if not isinstance(document, dict) or not known:
        return
    for key, value in document.items():
        if (now := REPLACED_SETTINGS.get(f"{place}{key}")) is not None:
            fate = f"was replaced by {now}" if now else "is gone, and none takes its place; leave it out"
            raise UnusableSettings(f"setting {place}{key} {fate}; see deploy/teachpath.toml")
        if key not in known:
            raise UnusableSettings(f"there is no setting {place}{key}; known here: {', '.join(known)}")
        inner = next((k for k in (known[key], *get_args(known[key])) if is_dataclass(k)), None)
        _refuse_unknown(value, inner, f"{place}{key}.")


def _check_calibrations(calibrations: tuple[Calibration, ...]) -> None:
    _check_names("calibration", (c.name for c in calibrations))
    for c in calibrations:
        if c.scale <= 0:
            raise UnusableSettings(f"calibration {c.name} has a scale of {c.scale:g}; it should be greater than 0")
        if not math.isclose(norm := math.hypot(*c.rotation), 1.0, abs_tol=1e-6):
            raise UnusableSettings(f"calibration {c.name} has a rotation of length {norm:g}; a unit quaternion has 1")


def _check_scenes(scenes: tuple[Scene, ...]) -> None:
    _check_names("scene", (scene.name for scene in scenes))
    for scene in scenes:
        try:
            check_scene(scene)
        except UnusableInput as error:
            raise UnusableSettings(str(error)) from None


def _check_names(what: str, names: Iterable[str]) -> None:
    known: set[str] = set()
    for name in names:
        if not is_name(name):
            raise UnusableSettings(name_refusal(what, name))
        if name in known:
            raise UnusableSettings(f"there are two settings of the {what} {name}; rename one of them")
        known.add(name)
    if not known and what in ("calibration", "scene"):
        raise UnusableSettings(f"a station needs at least one {what}; leave the setting out for the built-in ones")
