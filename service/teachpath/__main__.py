"""The command line: `teachpath COMMAND`."""

from __future__ import annotations

import atexit
import os
import sys
from typing import Annotated, NoReturn

try:
    import typer

    from teachpath import __version__
    from teachpath.commands import (
        adaptation,
        arms,
        audit,
        backups,
        certificates,
        curves,
        demo,
        demonstrations,
        doctor,
        evaluate,
        exporting,
        importing,
        logins,
        moving,
        people,
        resources,
        scenes,
        station,
        stores,
        tasks,
        tls,
        tokens,
        work,
    )
except ModuleNotFoundError as _missing:
    sys.exit(f"teachpath: {_missing.name} is not installed; the service needs: pip install 'teachpath[service]'")

from teachpath.errors import TeachpathError
from teachpath_client.errors import ClientError
from teachpath_proto.tokens import TOKEN_VARIABLE

EXIT_STATUS = """Exit status: 0, done. 1, refused or failed, with a sentence. 2, the command line is wrong. 3, done, but
look: import took rejected demonstrations, or a dry run of doctor found faults that it would mend. 4, a fault is left
that somebody must see to (doctor, backup). 130, broken off by Ctrl-C."""

app: typer.Typer = typer.Typer(
    help="Teach a robot a path by showing it. Start with: teachpath demo. At work: serve; then, on its page or from "
    "other terminals, show the task (teachpath-client), learn, plan and run.",
    epilog=EXIT_STATUS,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
for _command in (
    demo.demo,
    station.serve,
    station.worker,
    importing.import_,
    work.replay,
    demonstrations.demonstrations,
    demonstrations.amend,
    work.recalibrate,
    work.learn,
    work.recut,
    work.plan,
    adaptation.adapt,
    adaptation.object_,
    moving.run,
    moving.stop,
    moving.acknowledge,
    resources.status,
    resources.tasks,
    resources.runs,
    resources.paths,
    resources.plans,
    resources.jobs,
    resources.executions,
    resources.arms,
    resources.scenes,
    evaluate.evaluate,
    evaluate.diff,
    doctor.doctor,
    backups.backup,
    backups.restore,
    backups.prune,
):
    app.command(name=_command.__name__.rstrip("_"))(_command)
app.add_typer(exporting.app, name="export")
app.add_typer(tasks.app, name="task")
app.add_typer(curves.app, name="curve")
app.add_typer(arms.app, name="arm")
app.add_typer(scenes.app, name="scene")
app.add_typer(logins.app, name="login")
app.add_typer(certificates.app, name="station")
app.add_typer(stores.app, name="store")
app.add_typer(audit.app, name="audit")
app.add_typer(tls.app, name="tls")
app.add_typer(tokens.app, name="token")
app.add_typer(people.app, name="person")
for _part in (station.executor, station.simulator):
    app.command(rich_help_panel="Parts that serve starts by itself")(_part)


def _print_version(wanted: bool) -> None:
    if wanted:
        print(f"teachpath {__version__}")
        raise typer.Exit


@app.callback()
def take_options(
    token: Annotated[
        str, typer.Option(help="Who you are, for this command; others see it in the list of processes: better keep it.")
    ] = "",
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Pass on a token of the command line where every client looks for it."""
    if token:
        os.environ[TOKEN_VARIABLE] = token


def main() -> None:
    """Run the command line; a refusal ends with its sentence and exit status 1."""
    try:
        app(prog_name="teachpath")
        ending: str | int | None = 0
    except (TeachpathError, ClientError) as error:
        ending = f"teachpath: {error}"
    except SystemExit as leaving:
        ending = leaving.code
    if isinstance(ending, str):
        print(ending, file=sys.stderr)
    _leave(1 if isinstance(ending, str) else ending or 0)


def _leave(status: int) -> NoReturn:
    """End this process, in which everything that was started has been stopped in order.

    Taking the compiled libraries apart module by module can take seconds on a busy machine, while an operator waits.
    """
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)


if __name__ == "__main__":
    main()
