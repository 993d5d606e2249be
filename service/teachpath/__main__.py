"""The command line: `teachpath COMMAND`."""

from __future__ import annotations

import atexit
import os
import sys
from typing import NoReturn

try:
    import typer

    from teachpath.commands import (
        adaptation,
        backups,
        certificates,
        curves,
        demo,
        demonstrations,
        doctor,
        evaluate,
        files,
        importing,
        logins,
        station,
        stores,
        work,
    )
except ModuleNotFoundError as missing:
    sys.exit(f"teachpath: {missing.name} is not installed; the service needs: pip install 'teachpath[service]'")

from teachpath.errors import TeachpathError
from teachpath_client.errors import ClientError

app = typer.Typer(
    help="Teach a robot a path by showing it. Start with: teachpath demo. At work: serve; then, on its page or from "
    "other terminals, show the task (teachpath-client), learn, plan and run.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
for command in (
    demo.demo,
    station.serve,
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
    work.run,
    work.stop,
    work.acknowledge,
    evaluate.evaluate,
    evaluate.diff,
    files.export,
    doctor.doctor,
    backups.backup,
    backups.restore,
    backups.prune,
):
    app.command(name=command.__name__.rstrip("_"))(command)
app.add_typer(curves.app, name="curve")
app.add_typer(logins.app, name="login")
app.add_typer(certificates.app, name="station")
app.add_typer(stores.app, name="store")
for part in (station.executor, station.simulator):
    app.command(rich_help_panel="Parts that serve starts by itself")(part)


def main() -> None:
    """Run the command line; a refusal ends with its sentence and exit status 1."""
    try:
        app()
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
