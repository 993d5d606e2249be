"""Plan a learned path, move the arm along it, and follow its progress, at a running station.

Planning proves that the arm can follow the path: the plan carries a certificate with the largest use of every limit.
Only such a plan moves the arm. Learn a task first (02_learn_over_rest.py), then:

    python 03_run_a_path.py [--task arc] [--override 1.0] [--url http://127.0.0.1:8765]
"""

import argparse
import sys

from teachpath_client import ClientError, Station
from teachpath_client.models import Execution


def main() -> None:
    """Plan the newest path of the task, execute it, and print how it went."""
    parser = argparse.ArgumentParser(description="Move the arm along the newest learned path of a task.")
    parser.add_argument("--task", default="arc")
    parser.add_argument("--override", type=float, default=1.0, help="share of the planned speed")
    parser.add_argument("--url", default="http://127.0.0.1:8765")
    options = parser.parse_args()
    try:
        execution = plan_and_run(options)
    except ClientError as error:
        sys.exit(str(error))
    status = execution.status
    print(f"{status.state}: tracking error {status.tracking_error:.4f} rad, {status.missed} setpoints missed")


def plan_and_run(options: argparse.Namespace) -> Execution:
    """Return the execution when it has ended; raises ClientError when the arm cannot follow the path, or stops."""
    with Station(options.url) as station:
        run = station.newest_run(options.task)
        if run is None:
            raise ClientError(f"nothing was learned for task {options.task} yet; run 02_learn_over_rest.py first")
        plan = station.plan(run.learned.paths[0].id)
        certificate = plan.certificate
        for limit in (certificate.velocity_use, certificate.acceleration_use, certificate.jerk_use):
            print(f"{limit.value:.0%} of a limit by {limit.place}")
        print(f"{certificate.clearance.value:.3f} m clear: {certificate.clearance.place}")
        return station.run(plan.id, override=options.override, on_change=show)


def show(execution: Execution) -> None:
    """Print how far the arm has come."""
    print(f"{execution.status.state:12} {execution.status.progress:6.1%}", flush=True)


if __name__ == "__main__":
    main()
