"""run, stop and acknowledge: the arm moves, comes to rest, and may move again."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.options import Config, Json, Url, connected, stop_addresses
from teachpath.commands.printing import print_answer, print_json
from teachpath.commands.progress import execution_shown, progress_bar
from teachpath.commands.references import find_path, find_plan
from teachpath.errors import TeachpathError, UnusableInput
from teachpath_client.errors import ClientError
from teachpath_proto.control import ExecutorState

if TYPE_CHECKING:
    from teachpath import records
    from teachpath_client.models import Execution, ExecutorStatus
    from teachpath_client.station import Station


def run(
    plan: Annotated[
        str | None,
        typer.Argument(
            help="An id of a plan or its beginning, TASK/CLUSTER, or last; with --check the one that was meant, with "
            "--adapt a path."
        ),
    ] = None,
    url: Url = "",
    config: Config = None,
    override: Annotated[float, typer.Option(min=0.0, max=1.0, help="Share of the planned speed.")] = 1.0,
    check: Annotated[
        Path | None,
        typer.Option(
            help="Move nothing; judge this log of setpoints against limits and path: MCAP, or CSV t,q1,...,q6."
        ),
    ] = None,
    detach: Annotated[
        bool, typer.Option(help="Only start it: the arm goes on without this command, and anybody may command it.")
    ] = False,
    adapt: Annotated[
        bool, typer.Option(help="First adapt a path to where the station knows its object to lie, and certify it.")
    ] = False,
    goal: Annotated[str, typer.Option(help="With --adapt: where it is to go, x,y,z [m]; where the path ends.")] = "",
    json_: Json = False,
) -> None:
    """Move the arm along a certified plan, or judge what was sent to one.

    This command is in control meanwhile. Ctrl-C stops the arm on its path; when the command is killed or hangs, the arm
    is held there within 4 s. None of this is an emergency stop.
    """
    from teachpath.commands.adaptation import adapted_plan
    from teachpath.commands.checking import judge_file

    if check is not None:
        judge_file(check, plan, url, config, json_=json_)
        return
    if plan is None:
        raise UnusableInput("name the plan to run, or last; teachpath plans lists them, teachpath plan PATH makes one")
    if goal and not adapt:
        raise UnusableInput("--goal is for --adapt; a plan has its goal")
    with connected(url, operator="teachpath run") as station:
        chosen = adapted_plan(station, find_path(station, plan), "", goal).id if adapt else find_plan(station, plan)
        if detach:
            execution = station.begin_execution(chosen, override=override)
            if json_:
                print_json(execution)
                return
            print(f"{execution.id} {execution.status.state}; teachpath stop {execution.id} stops it")
            return
        execution = _run_to_its_end(station, chosen, override)
    if json_:
        print_json(execution)
        return
    status = execution.status
    print(
        f"{execution.id} {status.state}: {status.cycles} setpoints, {status.late} late, "
        f"{status.missed} missed; limits used to {status.limit_use:.1%}, "
        f"tracking error up to {1e3 * status.tracking_error:.2f} mrad"
    )


def _run_to_its_end(station: Station, plan: str, override: float) -> Execution:
    with station.control(), progress_bar("running") as show:
        execution = station.begin_execution(plan, override=override)
        try:
            return station.finish(execution, execution_shown(show))
        except KeyboardInterrupt:
            return station.finish(station.stop(execution.id), execution_shown(show))


def stop(
    execution: Annotated[
        str, typer.Argument(help="An id of an execution or its beginning; empty: whatever moves.")
    ] = "",
    url: Url = "",
    json_: Json = False,
) -> None:
    """Stop the arm on its path, whoever moves it.

    It says "stopped" when the executor's own status shows it; else it says NOT STOPPED and ends with exit status 1,
    while the service goes on trying. A service of yours on this machine that does not answer within 0.3 s is passed by:
    the stop goes over its bus, too. Where it is not clear which service is meant, all that you run are told. This is
    not an emergency stop.
    """
    from teachpath.commands.stopping import stop_arm

    failed: TeachpathError | ClientError | None = None
    for address in [url] if url else stop_addresses():
        try:
            status = stop_arm(address, execution)
        except (TeachpathError, ClientError) as error:  # the others are told all the same
            failed = failed or error
            continue
        print_answer(status, f"stopped: {_at_rest(status)}", json_=json_)
    if failed is not None:
        raise failed


def _at_rest(status: ExecutorStatus | records.ExecutorStatus) -> str:
    if not ExecutorState(status.state).is_resting:
        return f"{status.execution} comes to rest on its path"
    return f"{status.execution} has {status.state}" if status.execution else "nothing moves the arm"


def acknowledge(url: Url = "", json_: Json = False) -> None:
    """Let the arm be moved again that moved unasked, once you have seen why.

    Nothing starts before; it is refused while the arm does not rest for 2 s.
    """
    with connected(url, operator="teachpath acknowledge") as station:
        status = station.acknowledge_motion()
    print_answer(status, "acknowledged: executions may start", json_=json_)
