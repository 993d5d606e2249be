"""What people call runs, paths, plans, jobs and executions: by id, by the beginning of one, or by words.

A task is meant by its name, or by the display name from which that was made: `"Küche räumen"` is `kueche-raeumen`.
`last` is the newest; `TASK/2` is the path of cluster 2 of the task's newest run, and where a plan is wanted the newest
plan of that path; `TASK` is its newest run, or its only path.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final, Protocol, TypeVar

from teachpath.errors import NotFound, UnusableInput
from teachpath_proto.display_names import id_of

if TYPE_CHECKING:
    from teachpath_client.models import PathSummary, RunSummary
    from teachpath_client.station import Station

MAX_NAMED: Final = 5  # ids that a sentence names
WHOLE_ID: Final = re.compile(r"[a-z]+-[0-9a-f]{12}(-\d+)?")
LAST_WORD: Final = "last"


class _Listed(Protocol):
    @property
    def id(self) -> str: ...


Entry = TypeVar("Entry", bound=_Listed)


def id_or_words(words: str) -> str:
    """Return the name of the task or scene that is meant."""
    return id_of(words) or words


def find_run(station: Station, words: str) -> RunSummary:
    """Return the run that is meant; raises NotFound, or UnusableInput where several are."""
    runs = station.runs()
    newest = next((run for run in runs if run.task == id_or_words(words)), None)
    return newest or pick("run", words, runs)


def find_path(station: Station, words: str) -> str:
    """Return the id of the path that is meant; raises NotFound, or UnusableInput where several are."""
    if WHOLE_ID.fullmatch(words):
        return words
    paths = station.paths()
    task, slash, cluster = words.partition("/")
    task = id_or_words(task)
    if slash or any(path.task == task for path in paths):
        return _of_newest_run(paths, task, cluster).id
    if words == LAST_WORD and paths:
        return _of_newest_run(paths, paths[0].task, "").id
    return pick("path", words, paths).id


def find_plan(station: Station, words: str) -> str:
    """Return the id of the plan that is meant; raises NotFound, or UnusableInput where several are."""
    if WHOLE_ID.fullmatch(words):
        return words
    if "/" in words:
        path = find_path(station, words)
        found = next((plan for plan in station.plan_summaries() if plan.path == path), None)
        if found is None:
            raise NotFound(f"path {words} has no plan; make one with: teachpath plan {words}")
        return found.id
    return pick("plan", words, station.plan_summaries()).id


def find_job(station: Station, words: str) -> str:
    """Return the id of the job that is meant; raises NotFound, or UnusableInput where several are."""
    return words if WHOLE_ID.fullmatch(words) else pick("job", words, station.jobs()).id


def find_execution(station: Station, words: str) -> str:
    """Return the id of the execution that is meant; raises NotFound, or UnusableInput where several are."""
    return words if WHOLE_ID.fullmatch(words) else pick("execution", words, station.executions()).id


def pick(kind: str, words: str, entries: Sequence[Entry]) -> Entry:
    """Return the one of `entries`, newest first, that has this id, or whose id begins so, with its kind or without.

    Raises:
        NotFound: there is none.
        UnusableInput: several begin so.
    """
    if words == LAST_WORD and entries:
        return entries[0]
    exact = [entry for entry in entries if words in (entry.id, _rest(entry.id))]
    found = exact or [e for e in entries if words and (e.id.startswith(words) or _rest(e.id).startswith(words))]
    if not found:
        raise NotFound(f"there is no {kind} {words!r}; list them with: teachpath {kind}s")
    if len(found) > 1:
        named = ", ".join(entry.id for entry in found[:MAX_NAMED])
        more = f" and {len(found) - MAX_NAMED} more" if len(found) > MAX_NAMED else ""
        raise UnusableInput(f"{len(found)} {kind}s begin with {words!r}: {named}{more}; write more of the one")
    return found[0]


def _rest(id: str) -> str:
    return id.partition("-")[2]


def _of_newest_run(paths: Sequence[PathSummary], task: str, cluster: str) -> PathSummary:
    of_task = [path for path in paths if path.task == task]
    if not of_task:
        raise NotFound(
            f"task {task!r} has no learned path; list all with: teachpath paths; first: teachpath learn {task}"
        )
    newest = sorted((p for p in of_task if p.run == of_task[0].run), key=lambda path: path.cluster)
    known = ", ".join(f"{task}/{path.cluster}" for path in newest)
    found = [path for path in newest if not cluster or str(path.cluster) == cluster]
    if not found:
        raise NotFound(f"there is no path {task}/{cluster}; the newest run of {task} has {known}")
    if len(found) > 1:
        raise UnusableInput(f"the newest run of {task} has {len(found)} paths; say which: {known}")
    return found[0]
