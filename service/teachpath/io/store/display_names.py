"""Display names of tasks: no two tasks are called so that one is taken for the other."""

from __future__ import annotations

from sqlalchemy import select
from sqlalchemy.orm import Session

from teachpath.errors import Conflict
from teachpath.io.store.engine import lock_name
from teachpath.io.store.tables import TaskRow
from teachpath_proto.display_names import id_of


def require_distinct(session: Session, task: str, display_name: str) -> None:
    """Raise Conflict where another task has a display name, or a name, from which the same id would be made.

    Args:
        session: of the change; whoever gives the same name waits for its end.
        task: name of the task that is to be called so.
        display_name: that it gets; empty: its name, which no other task has.
    """
    if not display_name:
        return
    wanted = id_of(display_name).lower()
    lock_name(session, "display name", wanted)
    for row in session.scalars(select(TaskRow).where(TaskRow.name != task)):
        if wanted in (row.name.lower(), id_of(row.display_name).lower()):
            called = f", called {row.display_name!r}" if row.display_name else ""
            raise Conflict(
                f"{display_name!r} looks like the name of task {row.name}{called}; choose that task, or give another "
                "name"
            )
