"""Where the store keeps what lasts."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class StoreSettings:
    """Where lasting things are kept."""

    # folder of the database and the recordings; made when missing
    data_dir: str = "teachpath-data"
    # SQLAlchemy URL, e.g. postgresql+psycopg://user@host/teachpath; empty: SQLite in data_dir
    database: str = ""
    # name of this station among those that share the database, each with a data_dir of its own
    station: str = ""
