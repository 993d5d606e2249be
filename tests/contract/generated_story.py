"""What the client that openapi-python-client generates does at a station: it shows, learns, plans, and is refused.

`generated_clients` runs it, in the environment of the generators: `generated_story.py URL FILE ...`, with the generated
package on the path. Each FILE is a demonstration.
"""

import sys
import time
from io import BytesIO
from pathlib import Path
from typing import TypeVar

from teachpath_rest import AuthenticatedClient
from teachpath_rest.api.jobs import begin_job, get_job
from teachpath_rest.api.results import begin_plan, get_path, get_plan, get_run
from teachpath_rest.api.tasks import get_task, import_demonstrations, list_demonstrations, make_task
from teachpath_rest.models import Job, NewJob, NewJobKind, NewPlan, NewTask, Refusal
from teachpath_rest.types import File

TASK = "generated"
UNENDED_STATES = ("queued", "running")
T = TypeVar("T")


def done(answer: T | Refusal | None) -> T:
    """Return what was answered; raises where it was a refusal."""
    if answer is None or isinstance(answer, Refusal):
        raise SystemExit(f"refused: {answer}")
    return answer


def ended(client: AuthenticatedClient, job: Job) -> str:
    """Wait for the end of a job, and return the id of what it made."""
    while job.state in UNENDED_STATES:
        time.sleep(0.2)
        job = done(get_job.sync(job.id, client=client))
    if job.state != "succeeded":
        raise SystemExit(f"{job.kind} {job.state}: {job.message}")
    return job.outcome


def main(url: str, *files: str) -> None:
    """Teach a station, and print what was learned and planned."""
    client = AuthenticatedClient(base_url=url, token="of nobody: this station asks for none")
    done(make_task.sync(TASK, client=client, body=NewTask(scene="empty")))
    for file in files:
        content = File(BytesIO(Path(file).read_bytes()))
        ended(client, done(import_demonstrations.sync(TASK, client=client, body=content, name=Path(file).name)))
    shown = done(list_demonstrations.sync(TASK, client=client))
    learning = done(begin_job.sync(TASK, client=client, body=NewJob(kind=NewJobKind.LEARN)))
    run = done(get_run.sync(TASK, ended(client, learning), client=client))
    path = done(get_path.sync(run.learned.paths[0].id, client=client))
    planning = done(begin_plan.sync(path.id, client=client, body=NewPlan(version=1)))
    plan = done(get_plan.sync(ended(client, planning), client=client))
    refusal = get_task.sync("moon", client=client)
    if not isinstance(refusal, Refusal) or refusal.status != 404:
        raise SystemExit(f"this was to be refused: {refusal}")
    print(f"{len(shown)} demonstrations, {len(path.curve.control_points)} control points, {plan.duration:.2f} s")
    print(f"refused as it should be: {refusal.detail}")


if __name__ == "__main__":
    main(*sys.argv[1:])
