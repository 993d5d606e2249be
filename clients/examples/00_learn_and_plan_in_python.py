"""Learn paths from arrays and plan them, in one process and without a service.

`teachpath.learn` takes demonstrations as arrays (n, 3) of positions x, y, z [m], or (n, 7) with unit quaternions w, x,
y, z, or as tables with such columns; it finds the different ways in which the task was done. `teachpath.plan` proves
that the arm can follow a path, or says where it cannot and which control point to move. Here two ways lead over the
table, and one leaves the reach of the arm:

    python 00_learn_and_plan_in_python.py [--setpoints FILE.csv]
"""

import argparse

import numpy as np

import teachpath


def shown(across: float, height: float) -> np.ndarray:
    """Return a motion (150, 3) [m] from one side of the table to the other, over a point at its middle."""
    u = np.sin(np.linspace(0.0, np.pi / 2, 150)) ** 2
    x, y, z = 0.50 + across * np.sin(np.pi * u), -0.25 + 0.5 * u, 0.60 + height * np.sin(np.pi * u)
    return np.column_stack([x, y, z])


def main() -> None:
    """Learn two ways, plan each, and write the setpoints of the last plan."""
    parser = argparse.ArgumentParser(description="Learn paths from arrays and plan them.")
    parser.add_argument("--setpoints", default="", metavar="FILE", help="CSV file of time and joints to write")
    options = parser.parse_args()

    heights = np.random.default_rng(1).normal(0.12, 0.005, 4)
    demonstrations = {f"straight {n}": shown(0.0, height) for n, height in enumerate(heights)}
    demonstrations |= {f"aside {n}": shown(0.6, height) for n, height in enumerate(heights)}
    learned = teachpath.learn(demonstrations, teachpath.LearningSettings(keep=3), dt=0.02)

    for cluster, path in zip(learned.clusters, learned.paths, strict=True):
        print(f"way {cluster.index}: {', '.join(sorted(cluster.members))}")
        print(f"  {len(path.curve.control_points)} control points, halfway at {path.curve(0.5).round(3).tolist()} m")
        try:
            plan = teachpath.plan(path)
        except teachpath.PathRefused as refused:
            print(f"  refused: {refused}")
            print(f"  the first place is {refused.failure.position}, by {refused.failure.fault}")
            continue
        use = plan.certificate.velocity_use
        print(f"  certified: {plan.duration:.2f} s, {use.value:.0%} of the speed limit by {use.place}")
        times, joints = teachpath.setpoints(plan, rate=250.0)
        print(f"  {len(times)} setpoints of six joints [rad]")
        if options.setpoints:
            np.savetxt(options.setpoints, np.column_stack([times, joints]), delimiter=",", fmt="%.6f")


if __name__ == "__main__":
    main()
