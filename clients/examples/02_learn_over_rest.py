"""Learn the ways in which a task was shown, over REST, and print the clusters.

`Station.learn` begins the work at a running station, waits for it, and returns the run that it made: clusters with the
log-likelihood of each demonstration, and one learned path (a NURBS) each. Show a task first
(01_publish_a_demonstration.py), then:

    python 02_learn_over_rest.py [--task arc] [--url http://127.0.0.1:8765]
"""

import argparse
import sys

from teachpath_client import ClientError, Station


def main() -> None:
    """Learn, and print a line for each cluster."""
    parser = argparse.ArgumentParser(description="Learn a task and print its clusters.")
    parser.add_argument("--task", default="arc")
    parser.add_argument("--url", default="http://127.0.0.1:8765")
    options = parser.parse_args()
    try:
        with Station(options.url) as station:
            numbers = {d.id: d.number for d in station.demonstrations(options.task)}
            run = station.learn(options.task, {"seed": 1})
    except ClientError as error:
        sys.exit(str(error))
    for cluster in run.learned.clusters:
        print(f"way {cluster.index}: {cluster.note or 'ranked by log-likelihood'}")
        for score in cluster.scores:
            kept = "kept" if score.selected else "left out"
            print(f"  demonstration {numbers[score.demonstration]}: {score.log_likelihood:10.1f}  {kept}")
    for path in run.learned.paths:
        off = f", at most {path.fit.largest * 1000:.1f} mm off" if path.fit else ""
        print(f"path {path.id}: {len(path.curve.control_points)} control points{off}")


if __name__ == "__main__":
    main()
