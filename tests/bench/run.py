"""make bench: measured figures, each beside a limit or a peer of the same run. Nothing here passes or fails."""

import argparse
import math
import time

from teachpath.records import Trajectory
from tests.bench import (
    access,
    doctor_kills,
    growth,
    inverse,
    lateness,
    learning,
    learning_jobs,
    learning_peers,
    learning_scale,
    lists,
    long_takes,
    model_arms,
    motion,
    page,
    page_load,
    plans,
    recording,
    recording_load,
    setpoint_delay,
    starting,
    stop_latency,
    timing,
)
from tests.bench.report import Figure, machine, print_report


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Measure teachpath on this machine.")
    parser.add_argument("--quick", action="store_true", help="fewer repetitions, executions cut short")
    parser.add_argument("what", nargs="?", choices=["scale"], help="how costs grow with a site alone; all but that")
    asked = parser.parse_args()
    quick = asked.quick
    began = time.monotonic()
    print(f"teachpath bench on {machine()}{', quick' if quick else ''}\n", flush=True)
    if asked.what == "scale":
        growth.report()
        return

    figures, trajectories = recording.measure(repeats=1 if quick else 5, samples=recording.DEMO * (1 if quick else 4))
    print_report("Recording: hand samples to MCAP files and rows, every sample accounted for", figures)
    print_report("Recording under load, as live", recording_load.measure(seconds=10.0 if quick else 60.0))
    print_report("Long takes", long_takes.measure(repeats=1 if quick else 3))
    print_report(
        "Learning and planning, in this process",
        learning.measure(trajectories, repeats=3 if quick else 7),
    )
    print_report("Learning beside other libraries: the same data, the same bound", _peers(trajectories, quick=quick))
    print_report("What a start costs", starting.measure(starts=1 if quick else 3))
    print_report("Learning jobs of a served station", learning_jobs.measure(starts=1 if quick else 5))
    print_report("Learning from thousands", learning_scale.measure(quick=quick))
    print_report("Lists of a large station: 5,000 demonstrations, 2,000 runs", lists.measure())
    print_report("Who sends a request", access.measure())
    print_report("Inverse kinematics beside another library", inverse.measure(repeats=3 if quick else 7))
    print_report(
        "Timing: how near to the limits, how soon it stops, what a cycle costs",
        timing.measure(repeats=1 if quick else 3),
    )
    print_report(
        "Random paths, planned and judged by an independent checker",
        plans.measure(count=10 if quick else 100),
    )
    for example in model_arms.PATH_LENGTHS:
        figures = model_arms.measure(example, count=10 if quick else 50)
        print_report(f"Arms from models, planned: {example}", figures)
    print_report(
        "An executor that oversleeps or dies, setpoints that are lost, at random moments on random paths",
        lateness.measure(paths=2 if quick else 10, moments=2 if quick else 10),
    )
    print_report(
        "A served station: jobs in their process, executor and simulated arm in theirs",
        motion.measure(repeats=1 if quick else 3, seconds=2.0 if quick else math.inf),
    )
    print_report("Setpoints on a busy machine", setpoint_delay.measure(seconds=5.0 if quick else 15.0))
    print_report("A stop while the station is busy", stop_latency.measure(stops=100 if quick else 600))
    print_report("A doctor that is killed and run again", doctor_kills.measure(count=20 if quick else 200))
    print_report("What the page loads", page_load.measure())
    print_report("The editor in the page", page.measure(drags=5 if quick else 20))
    print(f"took {time.monotonic() - began:.0f} s")


def _peers(trajectories: dict[str, Trajectory], *, quick: bool) -> list[Figure]:
    repeats = 3 if quick else 7
    return learning_peers.fits(repeats=repeats) + learning_peers.pipeline(trajectories, repeats=repeats)


if __name__ == "__main__":
    main()
