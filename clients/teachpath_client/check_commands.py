"""The commands that check a driver or a tracker of one's own against the contract."""

from __future__ import annotations

import argparse

from teachpath_client.errors import ClientError


def add_driver_check(check: argparse.ArgumentParser) -> None:
    """Add the arguments of `teachpath-client driver-check`."""
    check.add_argument("--listen", default="tcp/127.0.0.1:7557", help="where the driver connects (%(default)s)")
    check.add_argument("--robot", default="puma560", help="name of the arm (%(default)s)")
    check.add_argument("--prefix", default="teachpath/station", help="of the keys (%(default)s)")
    tolerance = "that a joint may be off its setpoint while it follows (%(default)s)"
    check.add_argument("--tolerance", type=float, default=0.02, metavar="RAD", help=tolerance)
    check.add_argument("--yes", action="store_true", help="move the arm without asking")
    check.set_defaults(run=_check_driver)


def _check_driver(options: argparse.Namespace) -> None:
    from teachpath_client.driver.check_bench import check_driver

    given = options.listen, options.robot, options.prefix
    if not check_driver(*given, tolerance=options.tolerance, confirmed=options.yes):
        raise ClientError("the driver breaks a rule; a real arm should not be moved by it")


def add_tracker_check(check: argparse.ArgumentParser) -> None:
    """Add the arguments of `teachpath-client tracker-check`."""
    check.add_argument("--listen", default="tcp/127.0.0.1:7557", help="where the tracker connects (%(default)s)")
    check.add_argument("--prefix", default="teachpath/station", help="of the keys (%(default)s)")
    check.add_argument("--seconds", type=float, default=30.0, help="end so long after the first sample (%(default)s)")
    check.set_defaults(run=_check_tracker)


def _check_tracker(options: argparse.Namespace) -> None:
    from teachpath_client.tracker_check.bench import check_tracker

    if not check_tracker(options.listen, options.prefix, seconds=options.seconds):
        raise ClientError("the tracker breaks a rule; a station would lose or reject what it shows")
