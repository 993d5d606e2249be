"""The scenes that were changed at a station: every version is kept, the newest one counts."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Final

from sqlalchemy import Engine, func, select
from sqlalchemy.orm import Session

from teachpath.errors import Conflict, NotFound, UnusableInput
from teachpath.io.documents import from_document, to_document
from teachpath.io.store.changes import Changed, changing, unheard
from teachpath.io.store.engine import lock_name
from teachpath.io.store.rows import demonstration_document, demonstration_of
from teachpath.io.store.tables import DemonstrationRow, SceneRow, TaskRow
from teachpath.records import ObjectPose, SavedScene, Scene, SceneVersion

MAX_VERSIONS: Final = 10_000  # of one scene
MAX_SHOWN_TASKS: Final = 5
FIRST_NOTE: Final = "as the settings have it"


class StoredScenes:
    """The scenes of a database, which all stations on it share; safe to use from several threads.

    Of a scene of the settings, `first` in what follows, nothing is stored before it is changed; then it is version 1.
    """

    def __init__(self, engine: Engine, changed: Changed = unheard) -> None:
        self._engine, self._changed = engine, changed
        self._read: dict[str, SavedScene] = {}  # the newest version of each that was asked for; none ever changes

    def newest(self, name: str) -> SavedScene | None:
        """Return the newest version of a scene; None: nothing is stored of it."""
        if "\0" in name:  # which no database with a server keeps
            return None
        with Session(self._engine) as session:
            number = session.scalar(select(func.max(SceneRow.version)).where(SceneRow.name == name))
            if number is None:
                return None
            known = self._read.get(name)
            if known is None or known.version.number != number:
                known = self._read[name] = _saved(session.get_one(SceneRow, (name, number)))
        return known

    def names(self) -> list[str]:
        """List the names of which versions are stored, those of removed scenes too."""
        with Session(self._engine) as session:
            return list(session.scalars(select(SceneRow.name).distinct().order_by(SceneRow.name)))

    def versions(self, name: str) -> list[SceneVersion]:
        """List the stored versions of a scene, newest first."""
        question = select(SceneRow).where(SceneRow.name == name).order_by(SceneRow.version.desc())
        with Session(self._engine) as session:
            return [_version(row) for row in session.scalars(question)] if "\0" not in name else []

    def version(self, name: str, number: int) -> SavedScene | None:
        """Return one stored version; None: there is none."""
        with Session(self._engine) as session:
            known = "\0" not in name and 0 < number <= MAX_VERSIONS
            row = session.get(SceneRow, (name, number)) if known else None
            return _saved(row) if row else None

    def save(
        self, scene: Scene, first: Scene | None, *, base: int | None = None, author: str = "", note: str = ""
    ) -> SceneVersion:
        """Store the next version of a scene and return it; the newest one where that holds the same.

        Demonstrations that lay where the scene had its object keep that place.

        Args:
            scene: as it is from now on.
            first: the scene of this name in the settings; None: they have none.
            base: number of the version that was changed, 0 for a new scene; None: whichever is the newest.
            author: who changed it.
            note: why.

        Raises:
            Conflict: there is a newer version than the base, or the scene gets an object that its demonstrations had
                not.
        """
        with changing(self._engine, self._changed) as session:
            lock_name(session, "scene", scene.name)
            newest = _newest(session, scene.name, first)
            number = newest.version.number if newest else 0
            if base is not None and base != number:
                raise Conflict(_outdated(scene.name, base, newest))
            is_same = newest and newest.scene == scene and newest.scene.display_name == scene.display_name
            if newest and is_same and not newest.version.removed:
                return newest.version
            if newest:
                _keep_places(session, newest.scene, scene)
            return _add(session, newest, scene, author, note)

    def remove(self, name: str, first: Scene | None, *, author: str = "") -> SceneVersion:
        """Store a version with which a scene is gone, and return it; all former ones stay.

        Raises:
            NotFound: there is no such scene.
            Conflict: a task is done in it.
        """
        with changing(self._engine, self._changed) as session:
            lock_name(session, "scene", name)
            newest = _newest(session, name, first)
            if newest is None or newest.version.removed:
                raise NotFound(f"there is no scene {name!r}")
            tasks = list(session.scalars(select(TaskRow.name).where(TaskRow.scene == name).order_by(TaskRow.name)))
            if tasks:
                more = f" and {len(tasks) - MAX_SHOWN_TASKS} more" if len(tasks) > MAX_SHOWN_TASKS else ""
                raise Conflict(
                    f"scene {name} stays: a task keeps its scene, and this is that of {', '.join(tasks[:5])}{more}"
                )
            return _add(session, newest, newest.scene, author, "", removed=True)


def _newest(session: Session, name: str, first: Scene | None) -> SavedScene | None:
    row = session.scalar(select(SceneRow).where(SceneRow.name == name).order_by(SceneRow.version.desc()).limit(1))
    if row is not None:
        return _saved(row)
    return SavedScene(first_version(first), first) if first else None


def first_version(scene: Scene) -> SceneVersion:
    """Return what is said of a scene of the settings that was never changed."""
    return SceneVersion(scene.name, 1, 0, note=FIRST_NOTE)


def _add(
    session: Session, newest: SavedScene | None, scene: Scene, author: str, note: str, *, removed: bool = False
) -> SceneVersion:
    """Store a version behind the newest one, and before it that one where it stands in the settings alone."""
    now, number = time.time_ns(), newest.version.number + 1 if newest else 1
    if number > MAX_VERSIONS:
        raise UnusableInput(f"scene {scene.name} has {MAX_VERSIONS} versions, which is the limit; copy it")
    if newest and not newest.version.created_ns:
        session.add(_row(replace(newest.version, created_ns=now), newest.scene))
    made = SceneVersion(scene.name, number, now, author, note, removed)
    session.add(_row(made, scene))
    return made


def _keep_places(session: Session, before: Scene, after: Scene) -> None:
    """Let demonstrations say themselves where the object lay, if they lay where the scene had it and has no more."""
    was, is_ = _place(before), _place(after)
    if was == is_:
        return
    of_scene = select(DemonstrationRow).join(TaskRow).where(TaskRow.scene == before.name)
    for row in session.scalars(of_scene):
        stored = demonstration_of(row)
        if stored.object_pose is not None:
            continue
        if was is None:
            raise Conflict(
                f"scene {before.name} had no object when demonstration {stored.number} of task {stored.task} was made, "
                "so it gets none now; copy it under another name, and make tasks with that one"
            )
        row.document = demonstration_document(replace(stored, object_pose=was))


def _place(scene: Scene) -> ObjectPose | None:
    return ObjectPose(scene.carried.position, scene.carried.orientation) if scene.carried else None


def _row(version: SceneVersion, scene: Scene) -> SceneRow:
    return SceneRow(
        name=version.scene,
        version=version.number,
        created_ns=version.created_ns,
        author=version.author,
        note=version.note,
        removed=version.removed,
        document=to_document(scene),
    )


def _version(row: SceneRow) -> SceneVersion:
    return SceneVersion(row.name, row.version, row.created_ns, row.author, row.note, row.removed)


def _saved(row: SceneRow) -> SavedScene:
    return SavedScene(_version(row), from_document(Scene, row.document))


def _outdated(name: str, base: int, newest: SavedScene | None) -> str:
    if newest is None:
        return f"there is no scene {name!r} whose version {base} could have been changed; leave base out to make it"
    by = f" by {newest.version.author}" if newest.version.author else ""
    return (
        f"scene {name} has version {newest.version.number}{by}, and this change began at version {base}; look at the "
        "newer one, and change that"
    )
