"""Temporary files that a killed process leaves in the data folder."""

from __future__ import annotations

import logging
import shutil
from collections.abc import Collection
from contextlib import suppress
from pathlib import Path
from typing import Final

from teachpath.io.store.faults import TEMPORARY
from teachpath.io.store.motions import REPAIR_SUFFIX
from teachpath.io.store.store import Store

log: logging.Logger = logging.getLogger("teachpath")

REPAIRS: Final = "repairs"  # folder in which the doctor makes recordings
TRANSFERS: Final = "transfers"  # folder of uploads and exports


def find_leftovers(data_dir: Path, kept_transfers: Collection[str]) -> list[Path]:
    """List the temporary files and folders of processes that are gone; nobody may be using the data folder.

    Args:
        data_dir: folder of the station's data.
        kept_transfers: names of the folders of uploads that jobs wait for.
    """
    found = [folder for folder in (data_dir / TRANSFERS).glob("*") if folder.name not in kept_transfers]
    if (repairs := data_dir / REPAIRS).exists():
        found.append(repairs)
    found += [file for ending in (TEMPORARY, REPAIR_SUFFIX) for file in data_dir.glob(f"*/**/*{ending}")]
    found += data_dir.glob(f"*{TEMPORARY}")
    return sorted(found)


def remove_leftovers(data_dir: Path, kept_transfers: Collection[str]) -> None:
    """Remove the temporary files of processes that are gone; as `find_leftovers`."""
    for path in find_leftovers(data_dir, kept_transfers):
        with suppress(OSError):
            remove_leftover(path)


def note_unnamed(store: Store) -> None:
    """Let health say of recordings that no row names, as after a database was lost, and log the torn ones."""
    named, recordings = store.checks.named_recordings(), store.recordings
    kept = recordings.kept_rows.places()  # which the recorder stores
    places = set(map(recordings.place, recordings.finished())) - kept
    unnamed = sum(place not in named and recordings.objects.address(place) not in named for place in places)
    if unfinished := len(recordings.unfinished()):
        log.warning("%d recordings were cut off; look at them with: teachpath doctor", unfinished)
    if unnamed:
        store.health.note_lost(f"{unnamed} recordings have no row; stop the service and run: teachpath doctor")


def remove_leftover(path: Path) -> None:
    """Remove a temporary file or folder; raises OSError."""
    if path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)
