"""Which task the preview and the guidance show: the one whose demonstrations have changed last."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

from teachpath.errors import NotFound
from teachpath.io.store.store import Store
from teachpath.records import Scene, Shape


@dataclass
class ShownTask:
    """Keeps the name of the task that is shown; empty: there is none.

    Attributes:
        store: of the tasks.
        scene: returns the scene of a name, with its object where it lies.
        first_scene: returns what is shown while there is no task.
        show_object: shows the object of a scene; None: there is none.
        request_guidance: has the demonstrations of a task compared.
    """

    store: Store
    scene: Callable[[str], Scene]
    first_scene: Callable[[], Scene]
    show_object: Callable[[Shape | None], None]
    request_guidance: Callable[[str], None]
    name: str = ""

    def show(self, task: str) -> None:
        """Show a task whose demonstrations have changed."""
        self.name = task
        self.request_guidance(task)
        self.show_scene()

    def show_newest(self) -> None:
        """Show the newest task, or where there is none, the first scene."""
        if tasks := self.store.tasks():
            self.show(tasks[-1].name)
        else:
            self.name = ""
            self.show_object(self.first_scene().carried)

    def leave(self, task: str) -> None:
        """Show another task where this one is shown, which was archived or renamed."""
        self.request_guidance(task)
        if self.name == task:
            self.show_newest()

    def show_scene(self, _: str = "") -> None:
        """Show the object of the task where it lies now; of one that another station renamed, nothing new."""
        with suppress(NotFound):
            if self.name:
                self.show_object(self.scene(self.store.task(self.name).scene).carried)
