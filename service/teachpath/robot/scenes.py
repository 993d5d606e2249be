"""The scenes of a station: as they were changed here last, else as the settings have them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

from teachpath.errors import Conflict, NotFound
from teachpath.io.store.scenes import StoredScenes, first_version
from teachpath.motion.collision.scene_checks import check_scene
from teachpath.records import SavedScene, Scene, SceneVersion
from teachpath_proto.display_names import id_of


class Scenes:
    """Finds, changes and removes scenes; safe to use from several threads.

    Args:
        stored: that were changed.
        configured: the scenes of the settings.
    """

    def __init__(self, stored: StoredScenes, configured: Sequence[Scene]) -> None:
        self._stored = stored
        self._configured = {scene.name: scene for scene in configured}

    def get(self, name: str) -> Scene:
        """Return the scene of a name; raises NotFound."""
        return self.newest(name).scene

    def newest(self, name: str) -> SavedScene:
        """Return the newest version of a scene; raises NotFound: there is none, or it was removed."""
        saved = self._newest(name)
        if saved is None:
            known = ", ".join(scene.name for scene in self.all())
            raise NotFound(f"there is no scene {name!r}; known: {known}")
        if saved.version.removed:
            raise NotFound(f"there is no scene {name!r} any more; bring it back with: teachpath scene restore {name}")
        return saved

    def all(self) -> list[Scene]:
        """List the scenes: those of the settings in their order, then the others by name."""
        names = dict.fromkeys((*self._configured, *self._stored.names()))
        found = (self._newest(name) for name in names)
        return [saved.scene for saved in found if saved and not saved.version.removed]

    def versions(self, name: str) -> list[SceneVersion]:
        """List the versions of a scene, newest first, of one that was removed too; raises NotFound."""
        if stored := self._stored.versions(name):
            return stored
        return [self.newest(name).version]

    def version(self, name: str, number: int) -> SavedScene:
        """Return one version; raises NotFound."""
        newest = self.versions(name)[0].number
        found = self._stored.version(name, number) or (self._newest(name) if number == newest else None)
        if found is None:
            raise NotFound(f"there is no version {number} of scene {name!r}; it has 1 to {newest}")
        return found

    @cached_property
    def notes(self) -> list[str]:
        """Which scenes of the settings did not count at the start, because others of their names were saved here."""
        stored = {name: self._stored.newest(name) for name in self._configured}
        return [
            f"scene {name} of the settings counts no more: version {saved.version.number}, which was saved here, does"
            for name, saved in stored.items()
            if saved and self._is_unknown(name)
        ]

    def save(
        self, scene: Scene, *, base: int | None = None, author: str = "", note: str = "", use: str = ""
    ) -> SceneVersion:
        """Keep a scene as the newest version of its name, and return that version.

        Args:
            scene: that `scene_preparation.prepared_scene` returned.
            base: see `StoredScenes.save`.
            author: who changed it.
            note: why.
            use: what goes on in the scene of this name now, in words; empty: nothing.

        Raises:
            Conflict: the scene is in use, another one is called so, or as `StoredScenes.save`.
        """
        if use and self._newest(scene.name):
            raise Conflict(f"scene {scene.name} stays as it is while {use}")
        self._require_distinct(scene)
        return self._stored.save(scene, self._configured.get(scene.name), base=base, author=author, note=note)

    def copy(self, name: str, copy: str, *, display_name: str = "", author: str = "") -> SceneVersion:
        """Keep a scene under another name, which no scene may have.

        Raises:
            NotFound: there is no scene `name`.
            Conflict: there is a scene `copy`.
        """
        original = self.newest(name)
        if self._newest(copy):
            raise Conflict(f"there is, or was, a scene {copy}; name another copy of {name}")
        made = replace(original.scene, name=copy, display_name=display_name)
        check_scene(made)
        self._require_distinct(made)
        note = f"copy of {name}, version {original.version.number}"
        return self._stored.save(made, None, base=0, author=author, note=note)

    def remove(self, name: str, *, author: str = "", use: str = "") -> SceneVersion:
        """Let a scene be gone; its versions stay, and one that is saved brings it back.

        Raises:
            NotFound: there is no such scene.
            Conflict: a task is done in it, it is in use, or it is the last one.
        """
        if use:
            raise Conflict(f"scene {name} stays while {use}")
        if [scene.name for scene in self.all()] == [name]:
            raise Conflict(f"scene {name} is the only one, and a station needs one; make another one first")
        self.newest(name)
        return self._stored.remove(name, self._configured.get(name), author=author)

    def _require_distinct(self, scene: Scene) -> None:
        """Raise Conflict where another scene has its display name, or one from which the same name would be made."""
        wanted = id_of(scene.display_name).lower()
        for other in self.all() if wanted else []:
            if other.name != scene.name and wanted in (other.name.lower(), id_of(other.display_name).lower()):
                raise Conflict(
                    f"{scene.display_name!r} looks like the name of scene {other.name}; choose that scene, or give "
                    "another name"
                )

    def _newest(self, name: str) -> SavedScene | None:
        saved = self._stored.newest(name)
        if saved is None and (scene := self._configured.get(name)) is not None:
            return SavedScene(first_version(scene), scene)
        return saved

    def _is_unknown(self, name: str) -> bool:
        """Tell whether a scene of the settings is none of the stored versions of its name."""
        numbers = (version.number for version in self._stored.versions(name))
        stored = (self._stored.version(name, number) for number in numbers)
        return not any(saved and saved.scene == self._configured[name] for saved in stored)
