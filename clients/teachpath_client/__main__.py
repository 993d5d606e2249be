"""The client's command line: `teachpath-client COMMAND`."""

from __future__ import annotations

import argparse
import json
import logging
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import cast

from teachpath_client.check_commands import add_driver_check, add_tracker_check
from teachpath_client.devices import TouchSource, configure, describe_sources, open_source
from teachpath_client.devices.cyberglove import GloveSettings
from teachpath_client.errors import ClientError
from teachpath_client.link import Link, given_login
from teachpath_client.live import HapticFeedback, calibrate_glove, ended_by_signals, record_live
from teachpath_client.pedal import pedal_or_none
from teachpath_client.reading import HandReading, Vector
from teachpath_client.replay import read_mcap
from teachpath_client.ros2.commands import COMMAND_HELP as ABOUT_ROS2
from teachpath_client.ros2.commands import add_ros2
from teachpath_client.station import Station
from teachpath_client.status import Status
from teachpath_client.stop_command import COMMAND_HELP as ABOUT_STOP
from teachpath_client.stop_command import add_stop
from teachpath_client.synthetic import experiment_1, experiment_2
from teachpath_client.tracker import Routine, Tracker
from teachpath_client.tracker_calibration import COLUMNS, lines, measure_points, read_points
from teachpath_proto import tracker_pb2
from teachpath_proto.logins import Role
from teachpath_proto.reports import report_document

ReadingFilter = Callable[[Iterator[HandReading]], Iterator[HandReading]]
COMMAND_HELP = {
    "tracker": "Publish from a device until Ctrl-C; the station cuts what comes into demonstrations. For example: "
    "teachpath-client tracker --source hand --option fastrak.port=/dev/ttyUSB0 --option glove.port=/dev/ttyUSB1 "
    "--option glove.calibration=glove.toml --task stack --scene paper",
    "sources": "List the sources that `tracker --source` knows, with their options.",
    "glove-calibrate": "Measure an open hand and a fist with a CyberGlove, and write them into a file for "
    "`tracker --option calibration=FILE`.",
    "tracker-calibrate": "Measure where the tracker's frame lies in the robot's world: hold the tracker still at three "
    "or more known points that do not lie on one line, e.g. corners of the table, four or more to see which one is "
    "wrong. The station keeps every version; demonstrations remember the one that they were recorded under.",
    "synthetic": "Show the paper's experiments with a synthetic hand, so that all can be tried without a device. For "
    "example: teachpath-client synthetic --task demo --scene paper --speed 4",
    "replay": "Play stored demonstrations as if they were live: every sample again at its pace, recorded anew.",
    "driver-check": "Check a driver of an arm before a station moves the arm by it: setpoints come late, doubled, in "
    "bursts or not at all, and a verdict is given for every rule of the contract. No station is needed.",
    "stop": ABOUT_STOP,
    "ros2": ABOUT_ROS2,
    "tracker-check": "Check a tracker of your own before a station records from it: the check listens as a station "
    "does, your tracker connects and shows something once, and a verdict is given for every rule of the contract "
    "(proto/README.md). No station is needed.",
}


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the client's command line."""
    options = parser_of_commands().parse_args(arguments)
    logging.basicConfig(format="teachpath-client: %(message)s", level=logging.WARNING)
    try:
        options.run(options)
    except ClientError as error:
        sys.exit(f"teachpath-client: {error}")
    except KeyboardInterrupt:
        sys.exit(130)


def parser_of_commands() -> argparse.ArgumentParser:
    """Return what reads the command line."""
    parser = argparse.ArgumentParser(
        prog="teachpath-client",
        description="Send demonstrations to a teachpath station, as a tracker does: over Zenoh, with sequence numbers, "
        "a device clock, and a handshake at the end that says what arrived. Start with: teachpath-client synthetic "
        "--task demo --scene paper, while `teachpath serve` runs.",
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    _add_tracker(tracker := commands.add_parser("tracker", help="publish from a device until Ctrl-C"))
    sources = commands.add_parser("sources", help="list the sources that there are")
    sources.set_defaults(run=_sources)
    calibrate = commands.add_parser("glove-calibrate", help="measure an open hand and a fist with a CyberGlove")
    calibrate.add_argument("file", type=Path, metavar="FILE", help="the calibration to write, e.g. glove.toml")
    calibrate.set_defaults(run=_calibrate_glove)
    _add_tracker_calibrate(frame := commands.add_parser("tracker-calibrate", help="measure the tracker's frame"))
    for command in (tracker, calibrate, frame):
        command.add_argument(
            "--option", type=_option, action="append", default=[], metavar="KEY=VALUE", help="of the device; repeatable"
        )
    synthetic = commands.add_parser("synthetic", help="show the paper's experiments with a synthetic hand")
    experiments = "1: twelve demonstrations of three ways (default); 2: five of one way, the last one shaky"
    synthetic.add_argument("--experiment", type=int, choices=(1, 2), default=1, help=experiments)
    synthetic.add_argument("--seed", type=int, default=1, help="same seed, same hand (default 1)")
    synthetic.set_defaults(run=_synthetic)
    replay = commands.add_parser("replay", help="play stored demonstrations as if they were live")
    replay.add_argument("sources", nargs="+", metavar="SOURCE", help="an MCAP file, or a demonstration's id")
    replay.add_argument("--url", default="http://127.0.0.1:8765", help="station that holds the ids (%(default)s)")
    replay.set_defaults(run=_replay)
    add_driver_check(commands.add_parser("driver-check", help="check a driver of an arm against the contract"))
    add_tracker_check(commands.add_parser("tracker-check", help="check a tracker against the contract"))
    add_stop(halt := commands.add_parser("stop", help="stop the arm over the bus, without the web service"))
    add_ros2(commands.add_parser("ros2", help="show the arm to ROS 2: joint states, TF, the trajectory of a plan"))
    for command in (tracker, synthetic, replay):
        command.add_argument("--task", default="demo", help="what is demonstrated (%(default)s)")
        command.add_argument("--scene", default="", help="makes a new task with this scene, e.g. paper or empty")
        command.add_argument("--calibration", default="", help="of the tracker's frame; default: the task's own")
        command.add_argument("--tracker", default="glove-1", help="name of this tracker (%(default)s)")
        command.add_argument("--speed", type=_speed, default=1.0, help="1 = real time (default)")
    for command in (tracker, synthetic, replay, halt):
        command.add_argument("--endpoint", default="tcp/127.0.0.1:7447", help="the station's (%(default)s)")
        command.add_argument("--prefix", default="teachpath/station", help="of the station's keys (%(default)s)")
        command.add_argument("--login", metavar="FILE", default="", help="as `teachpath login create` wrote it")
    for name, command in commands.choices.items():
        command.description = COMMAND_HELP[name]
    return parser


def _add_tracker(tracker: argparse.ArgumentParser) -> None:
    tracker.add_argument("--source", required=True, help="one of those that `teachpath-client sources` lists")
    tracker.add_argument("--pedal", default="", metavar="KEY", help="space, enter, a letter, or /dev/input/eventN")
    tracker.add_argument("--rate", type=float, default=0.0, metavar="HZ", help="of the device: takes are judged by it")
    tracker.add_argument("--armed", action="store_true", help="begin paused: pedal, fist or page begins the first take")
    tracker.add_argument("--countdown", type=float, metavar="S", help="[s] before each take; else as the station says")
    tracker.add_argument("--takes", type=_count, default=0, metavar="N", help="pause by itself after so many takes")
    tracker.add_argument("--one-by-one", action="store_true", help="pause after each take")
    tracker.set_defaults(run=_tracker)


def _add_tracker_calibrate(frame: argparse.ArgumentParser) -> None:
    frame.add_argument("name", metavar="NAME", help="of the calibration, e.g. lab; then: tracker --calibration lab")
    frame.add_argument("--source", default="", help="one of those that `teachpath-client sources` lists")
    frame.add_argument("--point", type=_place, action="append", default=[], metavar="X,Y,Z", help="[m, world]; repeat")
    frame.add_argument("--points", type=Path, metavar="FILE", help=f"instead: a CSV file of {','.join(COLUMNS)}")
    frame.add_argument("--fit-scale", action="store_true", help="find the scale too, for a device not in metres")
    frame.add_argument("--dry-run", action="store_true", help="only show the calibration and its residuals")
    frame.add_argument("--url", default="http://127.0.0.1:8765", help="of the station (%(default)s)")
    frame.set_defaults(run=_calibrate_tracker)


def _place(text: str) -> Vector:
    try:
        x, y, z = map(float, text.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text} is not X,Y,Z in metres, e.g. 0.58,-0.28,0.5") from None
    return x, y, z


def _count(text: str) -> int:
    count = int(text)
    if not 0 <= count <= 10_000:
        raise argparse.ArgumentTypeError(f"{text} is outside 0 to 10000")
    return count


def _speed(text: str) -> float:
    speed = float(text)
    if not 0.01 <= speed <= 100:
        raise argparse.ArgumentTypeError(f"{text} is outside 0.01 to 100")
    return speed


def _option(text: str) -> tuple[str, str]:
    key, separator, value = text.partition("=")
    if not key or not separator:
        raise argparse.ArgumentTypeError(f"{text} is not KEY=VALUE")
    return key, value


def _tracker(options: argparse.Namespace) -> None:
    source = open_source(options.source, dict(options.option))
    if source.capabilities.live and options.speed != 1.0:
        raise ClientError(f"{options.source} measures in real time; leave out --speed {options.speed:g}")
    routine = Routine(options.armed, options.countdown, options.takes, options.one_by_one)
    status = Status(sys.stderr)
    with (
        ended_by_signals(source),
        source,
        _link(options) as link,
        pedal_or_none(options.pedal) as reading_filter,
    ):
        tracker = Tracker(link, options.tracker, prefix=options.prefix)
        print(f"recording {options.task} from {options.source}; Ctrl-C ends it", file=sys.stderr)
        tracker.subscribe_feedback(status.on_feedback)
        reading_filter = _chained(status.readings, reading_filter)
        if source.capabilities.touch:
            haptic = HapticFeedback(cast("TouchSource", source))
            tracker.subscribe_feedback(haptic.on_feedback)
            reading_filter = _chained(haptic.readings, reading_filter)
        report = record_live(
            tracker,
            source,
            options.task,
            scene=options.scene,
            calibration=options.calibration,
            speed=options.speed,
            rate=options.rate,
            routine=routine,
            reading_filter=reading_filter,
        )
        status.end()
        _print(report)


def _chained(first: ReadingFilter, second: ReadingFilter) -> ReadingFilter:
    return lambda readings: second(first(readings))


def _sources(_options: argparse.Namespace) -> None:
    for name, line in describe_sources().items():
        print(f"{name:12} {line}")


def _calibrate_glove(options: argparse.Namespace) -> None:
    settings = configure(GloveSettings, dict(options.option))
    calibration = calibrate_glove(settings, lambda sentence: input(f"{sentence}, then press Enter: "))
    calibration.save(options.file)
    telling = sum(gain != 0.0 for gain in calibration.gain)
    print(f"{options.file}: {telling} of {len(calibration.gain)} sensors tell the open hand from the fist")


def _calibrate_tracker(options: argparse.Namespace) -> None:
    if bool(options.points) == bool(options.source and options.point):
        raise ClientError("name a --source and each --point, or a file of --points that were measured before")
    if options.points:
        pairs = read_points(options.points)
    else:
        make = partial(open_source, options.source, dict(options.option))
        pairs = measure_points(make, options.point, lambda sentence: input(f"{sentence}, then press Enter: "))
    with Station(options.url) as station:
        measured = station.measure_calibration(
            options.name,
            [(pair.tracker, pair.world) for pair in pairs],
            source=options.source or options.points.name,
            fit_scale=options.fit_scale,
            keep=not options.dry_run,
        )
    for line in lines(measured):
        print(line)


def _link(options: argparse.Namespace) -> Link:
    return Link(options.endpoint, login=given_login(options.login, Role.TRACKER))


def _synthetic(options: argparse.Namespace) -> None:
    experiment = experiment_1 if options.experiment == 1 else experiment_2
    with _link(options) as link:
        _record(Tracker(link, options.tracker, prefix=options.prefix), options, experiment(options.seed))


def _replay(options: argparse.Namespace) -> None:
    recordings = [_recording(source, options.url) for source in options.sources]
    with _link(options) as link:
        tracker = Tracker(link, options.tracker, prefix=options.prefix)
        for readings in recordings:
            _record(tracker, options, readings)


def _recording(source: str, url: str) -> list[HandReading]:
    file = Path(source)
    if file.suffix == ".mcap":
        try:
            return read_mcap(file.read_bytes())
        except OSError as error:
            raise ClientError(f"cannot read {source}: {error.strerror}") from error
    with Station(url) as station:
        return read_mcap(station.recorded_demonstration(source))


def _record(tracker: Tracker, options: argparse.Namespace, readings: Iterable[HandReading]) -> None:
    tracker.start(options.task, scene=options.scene, calibration=options.calibration)
    try:
        tracker.publish(readings, speed=options.speed)
    except BaseException:
        tracker.stop(discard=True)
        raise
    _print(tracker.stop())


def _print(report: tracker_pb2.RecordingReport) -> None:
    print(json.dumps(report_document(report)))


if __name__ == "__main__":
    main()
