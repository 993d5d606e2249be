"""demo: the main job from one command, on real sockets, files and processes."""

from __future__ import annotations

import json
import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from teachpath.commands.options import Config, motion_arm, settings_of, web_address

if TYPE_CHECKING:
    from teachpath.config import Settings


def demo(
    speed: Annotated[float, typer.Option(min=0.1, max=20, help="How fast the hand moves; 1 = real time.")] = 4.0,
    once: Annotated[bool, typer.Option("--once", help="End after the arm has moved, instead of staying up.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON; --once does so too.")] = False,
    seed: Annotated[int, typer.Option(help="Of the synthetic hand.")] = 1,
    recordings: Annotated[
        Path | None,
        typer.Option(help="Instead of the synthetic hand: import a RoboTasks file and replay it."),
    ] = None,
    arm: Annotated[
        str,
        typer.Option(
            help="Published Puma 560 (teachpath arms), kept arm (arm list), or example: six-axis, seven-axis."
        ),
    ] = "",
    port: Annotated[int | None, typer.Option(help="Web port; 8765, or a free one when that is taken.")] = None,
    data: Annotated[Path | None, typer.Option(help="Keep the data in this folder; else it is thrown away.")] = None,
    config: Config = None,
) -> None:
    """Show the whole way once, on this machine.

    A hand in a process of its own shows the paper's first experiment over Zenoh: twelve demonstrations, three ways
    around two obstacles. They are recorded, clustered and fitted; the first executable path is certified, and the
    simulated arm carries the block along it while you watch in the browser.
    """
    from rich.console import Console

    from teachpath.commands.demo_arm import prepare_arm
    from teachpath.commands.demo_steps import Demo
    from teachpath.commands.serving import serving, until_signalled
    from teachpath_client.station import Station

    console = Console(stderr=True)
    with ExitStack() as stack:
        folder = data or Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="teachpath-demo-")))
        settings = demo_settings(config, folder, port, arm)
        prepare_arm(settings, carries=recordings is None)
        stop = stack.enter_context(until_signalled())
        stack.enter_context(serving(settings))
        url = web_address(settings)
        console.print(f"teachpath serves [bold]{url}[/bold]: open it to watch; API docs at {url}/docs", highlight=False)
        station = stack.enter_context(Station(url, operator="teachpath demo"))
        demo = Demo(station, settings, stop, console)
        summary = demo.run(speed=speed, seed=seed, recordings=recordings)
        if as_json or once:
            print(json.dumps(summary, indent=2), flush=True)
        if not once:
            console.print(next_steps(url, summary), highlight=False)
            stop.wait()


def next_steps(url: str, summary: dict[str, Any]) -> str:
    """Return what one may do now, in three lines."""
    return (
        f"Next, while the service stays up (Ctrl-C ends it):\n"
        f"  look at the ways, edit one, or show one by mouse: {url}\n"
        f"  see what was made, from another terminal:         teachpath status; teachpath paths; teachpath runs last\n"
        f"  move the arm again:                               teachpath run {summary['plan']}"
    )


def demo_settings(config: Path | None, folder: Path, port: int | None, arm: str) -> Settings:
    """Read the settings with the arm that was named; keep to the default ports, or take free ones if they are taken."""
    from teachpath.commands.serving import free_port

    settings = settings_of(config, folder)
    web = port or (settings.web.port if _is_free(settings.web.port) else free_port())
    endpoint = settings.bus.endpoint
    if not _is_free(int(endpoint.rsplit(":", 1)[1])):
        endpoint = f"tcp/127.0.0.1:{free_port()}"
    return settings_of(config, folder, web={"port": web}, bus={"endpoint": endpoint}, **motion_arm(arm))


def _is_free(port: int) -> bool:
    import socket

    try:
        socket.create_server(("127.0.0.1", port)).close()
    except OSError:
        return False
    return True
