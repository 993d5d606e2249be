"""The command line: `teachpath COMMAND`."""

from __future__ import annotations

import sys

try:
    import typer

    from teachpath.commands import demo, files, station, work
except ModuleNotFoundError as missing:
    sys.exit(f"teachpath: {missing.name} is not installed; the service needs: pip install 'teachpath[service]'")

from teachpath.errors import TeachpathError

app = typer.Typer(
    help="Teach a robot a path by showing it. Start with: teachpath demo",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
for command in (
    demo.demo,
    station.serve,
    files.import_,
    work.replay,
    work.learn,
    work.plan,
    work.run,
    files.export,
    files.doctor,
):
    app.command(name=command.__name__.rstrip("_"))(command)
for part in (station.executor, station.simulator):
    app.command(rich_help_panel="Parts that serve starts by itself")(part)


def main() -> None:
    """Run the command line; a refusal ends with its sentence and exit status 1."""
    try:
        app()
    except TeachpathError as error:
        sys.exit(f"teachpath: {error}")


if __name__ == "__main__":
    main()
