"""Where the store keeps what lasts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Ge


@dataclass(frozen=True)
class StoreSettings:
    """Where lasting things are kept."""

    # folder of the database and the recordings; made when missing
    data_dir: str = "teachpath-data"
    # SQLAlchemy URL, e.g. postgresql+psycopg://user@host/teachpath; empty: SQLite in data_dir
    database: str = ""
    # name of this station among those that share the database, each with a data_dir of its own
    station: str = ""
    # object storage of finished recordings, s3://BUCKET/PREFIX, of this database alone; empty: they stay in data_dir
    recordings: str = ""
    # bytes of the objects that were read last of which data_dir keeps copies
    cache_size: Annotated[int, Ge(0)] = 2_147_483_648
