"""Options that several commands share, and what they mean: the settings, and the service to speak to."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from teachpath.errors import NotFound, TeachpathError, UnusableInput

if TYPE_CHECKING:
    from teachpath.config import Settings
    from teachpath.io.store.store import Store
    from teachpath_client.station import Station

Config = Annotated[Path | None, typer.Option("--config", help="Settings file; see deploy/teachpath.toml.")]
Data = Annotated[Path | None, typer.Option("--data", help="Folder of database and recordings.")]
Url = Annotated[
    str,
    typer.Option(
        "--url",
        envvar="TEACHPATH_URL",
        help="Address of the service; else the one of the settings, or the one that you run.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON, in the form of the REST API.")]
LOCAL_ADDRESS = "http://127.0.0.1:8765"
NOT_FOUND_PATTERN = re.compile(
    "there is no (task|demonstration|run|path|plan|job|execution) [^;]*$"
)  # as a station says
LISTED_BY = {"demonstration": " TASK"}


def settings_of(config: Path | None, data: Path | None, **changes: Any) -> Settings:
    """Read the settings, with the data folder and further changes of the command line laid over them."""
    from teachpath.config import load

    if data is not None:
        changes["store"] = {"data_dir": str(data)}
    return load(config, document=changes)


def stored_settings(config: Path | None, data: Path | None, *, may_make: bool = False) -> Settings:
    """Read the settings of a command that works on the data folder itself.

    Args:
        config: settings file.
        data: folder that the command line names.
        may_make: whether a folder that the command line names is made when it is missing.

    Raises:
        NotFound: there is no such folder; none is made by mistake.
    """
    settings = settings_of(config, data)
    folder = Path(settings.store.data_dir)
    if not folder.is_dir() and not (may_make and data is not None):
        make = f", or make it with: --data {folder}" if may_make else ""
        raise NotFound(f"there is no data folder {folder.absolute()}; name another one with --data or --config{make}")
    return settings


@contextmanager
def opened_store(settings: Settings) -> Iterator[Store]:
    """Open what a station keeps, and close it behind."""
    from teachpath.io.store.store import Store  # with the libraries of databases

    store = Store(settings.store)
    try:
        yield store
    finally:
        store.close()


def motion_arm(name: str) -> dict[str, Any]:
    """Return the settings that make a named arm that of the station; no name changes nothing."""
    from teachpath.motion.arm.puma560 import VARIANTS

    if not name:
        return {}
    return {"motion": {"variant": name} if name in VARIANTS else {"arm": name}}


def with_arm(settings: Settings) -> Settings:
    """Return settings with the model of the arm that they name, which the data folder has.

    Raises:
        UnusableSettings: it has none of that name.
        NotFound: there is no data folder.
    """
    if settings.motion.arm is None:
        return settings
    from teachpath.stored_arm import with_stored_arm

    folder = Path(settings.store.data_dir)
    if not folder.is_dir():
        raise NotFound(f"arm {settings.motion.arm} is kept in a data folder, and there is no {folder.absolute()}")
    with opened_store(settings) as store:
        return with_stored_arm(settings, store.arms)


@contextmanager
def connected(url: str, *, operator: str = "") -> Iterator[Station]:
    """Speak to the service at `url`, else to the one that `address` finds; `operator` is named in the journal."""
    from teachpath_client.errors import Refused
    from teachpath_client.station import Station

    with Station(url or address(), operator=operator) as station:
        try:
            yield station
        except Refused as refused:
            kind = NOT_FOUND_PATTERN.match(str(refused))
            if refused.status != 404 or kind is None:
                raise
            raise NotFound(f"{refused}; list them with: teachpath {kind[1]}s{LISTED_BY.get(kind[1], '')}") from None


def address() -> str:
    """Return the address of the service that is meant when none is given.

    That is the address of settings that name one, else the one service of this user that runs, else the default.

    Raises:
        UnusableInput: several run; the sentence names them.
    """
    if named := _named_in_settings():
        return named
    from teachpath.io.running_services import running_services

    running = [service.url for service in running_services()]
    if len(running) > 1:
        raise UnusableInput(f"several services run: {', '.join(running)}; say which with --url")
    return running[0] if running else LOCAL_ADDRESS


def stop_addresses() -> list[str]:
    """Return the addresses of the services that are to stop their arms; unreadable settings keep no stop back."""
    from teachpath.io.running_services import running_services

    try:
        return [address()]
    except TeachpathError:
        return [service.url for service in running_services()] or [LOCAL_ADDRESS]


def web_address(settings: Settings) -> str:
    """Return the address at which programs of this machine reach the web port of a station."""
    from teachpath.web.certificate import has_certificate

    web = settings.web
    scheme = "https" if has_certificate(web, settings.store.data_dir) else "http"
    reached = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(web.host, web.host)
    return f"{scheme}://{f'[{reached}]' if ':' in reached else reached}:{web.port}"


def _named_in_settings() -> str:
    variables = ("TEACHPATH_CONFIG", "TEACHPATH_WEB__HOST", "TEACHPATH_WEB__PORT")
    if not any(os.environ.get(name) for name in variables) and not Path("teachpath.toml").is_file():
        return ""
    from teachpath.config import load
    from teachpath.web.settings import WebSettings

    settings, default = load(), WebSettings()
    is_named = (settings.web.host, settings.web.port) != (default.host, default.port)
    return web_address(settings) if is_named else ""
