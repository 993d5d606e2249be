"""Options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from teachpath.config import Settings, load

Config = Annotated[Path | None, typer.Option("--config", help="Settings file; see deploy/teachpath.toml.")]
Data = Annotated[Path | None, typer.Option("--data", help="Folder of database and recordings.")]
Url = Annotated[str, typer.Option("--url", help="Address of the running service.")]
LOCAL = "http://127.0.0.1:8765"


def settings_of(config: Path | None, data: Path | None, **changes: Any) -> Settings:
    """Read the settings, with the data folder and further changes of the command line laid over them."""
    if data is not None:
        changes["store"] = {"data_dir": str(data)}
    return load(config, document=changes)
