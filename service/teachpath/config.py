"""The settings of every room in one frozen tree: defaults, one TOML file, then TEACHPATH_* variables.

A variable names its room and setting: `TEACHPATH_WEB__PORT=9000`.
"""

from __future__ import annotations

import os
import tomllib
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Annotated, Any

from annotated_types import Ge, Le
from pydantic import ValidationError
from pydantic_settings import BaseSettings, InitSettingsSource, PydanticBaseSettingsSource, SettingsConfigDict

from teachpath.errors import NotFound, UnusableSettings
from teachpath.io.bus import BusSettings
from teachpath.io.store import StoreSettings
from teachpath.learning import LearningSettings
from teachpath.motion import MotionSettings, paper_scene
from teachpath.motion.scenes import empty_scene
from teachpath.recording import RecordingSettings
from teachpath.records import Calibration, Scene
from teachpath.workers.executor import ExecutorSettings
from teachpath.workers.jobs import JobSettings
from teachpath.workers.simulator import SimulatorSettings

# RoboTasks (clfd datasets) was recorded in the frame of another arm; this maps it, shrunk, onto the Puma's table.
ROBOTASKS = Calibration("robottasks", scale=0.6, rotation=(1.0, 0.0, 0.0, 0.0), offset=(0.25, 0.0, 0.45))


@dataclass(frozen=True)
class WebSettings:
    """Where the REST API and the page are served."""

    # address to listen on; loopback unless a proxy with a login stands before it
    host: str = "127.0.0.1"
    # TCP port of the REST API, the page and its WebSocket
    port: Annotated[int, Ge(1), Le(65535)] = 8765
    # further names under which browsers may reach this station, e.g. behind a proxy
    hosts: tuple[str, ...] = ()
    # bytes of the largest file that may be imported over REST
    largest_upload: Annotated[int, Ge(1024)] = 67108864


class Settings(BaseSettings):
    """Every setting of a station."""

    model_config = SettingsConfigDict(
        env_prefix="TEACHPATH_", env_nested_delimiter="__", extra="forbid", frozen=True, env_ignore_empty=True
    )

    bus: BusSettings = BusSettings()
    web: WebSettings = WebSettings()
    store: StoreSettings = StoreSettings()
    recording: RecordingSettings = RecordingSettings()
    learning: LearningSettings = LearningSettings()
    motion: MotionSettings = MotionSettings()
    executor: ExecutorSettings = ExecutorSettings()
    simulator: SimulatorSettings = SimulatorSettings()
    jobs: JobSettings = JobSettings()
    calibrations: tuple[Calibration, ...] = (Calibration("identity"), ROBOTASKS)
    scenes: tuple[Scene, ...] = (paper_scene(), empty_scene())

    def scene(self, name: str) -> Scene:
        """Return the scene `name`; raises NotFound with the known ones."""
        return _named(self.scenes, name, "scene")

    def calibration(self, name: str) -> Calibration:
        """Return the calibration `name`; raises NotFound with the known ones."""
        return _named(self.calibrations, name, "calibration")


def load(file: Path | None = None, *, document: dict[str, Any] | None = None) -> Settings:
    """Read the settings: `document` wins over TEACHPATH_* variables, those over the file, that over the defaults.

    Args:
        file: TOML file; else TEACHPATH_CONFIG, else ./teachpath.toml when it exists.
        document: settings given on the command line.

    Raises:
        UnusableSettings: a setting that does not exist or is outside its limits; the sentence names it.
    """
    from_file = _read(file)

    class Sourced(Settings):
        @classmethod
        def settings_customise_sources(
            cls, settings_cls: type[BaseSettings], **sources: PydanticBaseSettingsSource
        ) -> tuple[PydanticBaseSettingsSource, ...]:
            return sources["init_settings"], sources["env_settings"], InitSettingsSource(settings_cls, from_file)

    for given in (from_file, document or {}):
        _refuse_unknown(given, Settings.model_construct(), "")
    try:
        return Sourced(**(document or {}))
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(str(p) for p in first["loc"])
        raise UnusableSettings(f"setting {place} = {first.get('input')!r}: {first['msg']}") from None


def _read(file: Path | None) -> dict[str, Any]:
    named = file or (Path(os.environ["TEACHPATH_CONFIG"]) if os.environ.get("TEACHPATH_CONFIG") else None)
    chosen = named or Path("teachpath.toml")
    if named is None and not chosen.is_file():
        return {}
    try:
        return tomllib.loads(chosen.read_text())
    except OSError as error:
        raise UnusableSettings(f"cannot read the settings file {chosen}: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise UnusableSettings(f"the settings file {chosen} is not TOML: {error}") from None


def _refuse_unknown(document: dict[str, Any], default: Any, place: str) -> None:
    """Name a setting that does not exist, which the dataclasses of the rooms would pass over."""
    known = [f.name for f in fields(default)] if is_dataclass(default) else list(type(default).model_fields)
    for key, value in document.items():
        if key not in known:
            raise UnusableSettings(f"there is no setting {place}{key}; known here: {', '.join(known)}")
        inner = getattr(default, key)
        if isinstance(value, dict) and is_dataclass(inner):
            _refuse_unknown(value, inner, f"{place}{key}.")


def _named(things: tuple[Any, ...], name: str, what: str) -> Any:
    for thing in things:
        if thing.name == name:
            return thing
    raise NotFound(f"there is no {what} {name!r}; known: {', '.join(t.name for t in things)}")
