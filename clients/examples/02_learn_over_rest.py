"""Learn the ways in which a task was shown, over REST, and print the clusters.

`POST /tasks/<task>/jobs` begins the work and answers at once with a job; its `outcome` is the id of the run that it
made: clusters with the log-likelihood of each demonstration, and one learned path (a NURBS) each. Show a task first
(01_publish_a_demonstration.py), then:

    python 02_learn_over_rest.py [--task arc] [--url http://127.0.0.1:8765]
"""

import argparse
import sys
import time

from teachpath_client.rest import Station


def main() -> None:
    """Learn, and print a line for each cluster."""
    parser = argparse.ArgumentParser(description="Learn a task and print its clusters.")
    parser.add_argument("--task", default="arc")
    parser.add_argument("--url", default="http://127.0.0.1:8765")
    options = parser.parse_args()
    with Station(options.url) as station:
        numbers = {d["id"]: d["number"] for d in station.call("GET", f"/tasks/{options.task}/demonstrations")}
        job = station.call("POST", f"/tasks/{options.task}/jobs", {"kind": "learn", "settings": {"seed": 1}})
        while not job["finished_ns"]:
            time.sleep(0.1)
            job = station.call("GET", f"/jobs/{job['id']}")
        if job["state"] != "succeeded":
            sys.exit(f"learning {job['state']}: {job['message']}")
        learned = station.call("GET", f"/tasks/{options.task}/runs/{job['outcome']}")["learned"]
    for cluster in learned["clusters"]:
        print(f"way {cluster['index']}: {cluster['note'] or 'ranked by log-likelihood'}")
        for score in cluster["scores"]:
            kept = "kept" if score["selected"] else "left out"
            print(f"  demonstration {numbers[score['demonstration']]}: {score['log_likelihood']:10.1f}  {kept}")
    for path in learned["paths"]:
        points, fit = path["curve"]["control_points"], path["fit"]
        print(f"path {path['id']}: {len(points)} control points, at most {fit['largest'] * 1000:.1f} mm off")


if __name__ == "__main__":
    main()
