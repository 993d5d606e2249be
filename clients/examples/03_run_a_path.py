"""Plan a learned path, move the arm along it, and follow its progress, over REST.

Planning proves that the arm can follow the path: the plan carries a certificate with the largest use of every limit.
Only such a plan moves the arm. Learn a task first (02_learn_over_rest.py), then:

    python 03_run_a_path.py [--task arc] [--override 1.0] [--url http://127.0.0.1:8765]
"""

import argparse
import sys
import time

from teachpath_client.rest import Station

ENDED = ("ended", "faulted", "idle")


def main() -> None:
    """Plan the newest path of the task, execute it, and print how it went."""
    parser = argparse.ArgumentParser(description="Move the arm along the newest learned path of a task.")
    parser.add_argument("--task", default="arc")
    parser.add_argument("--override", type=float, default=1.0, help="share of the planned speed")
    parser.add_argument("--url", default="http://127.0.0.1:8765")
    options = parser.parse_args()
    with Station(options.url) as station:
        runs = station.call("GET", f"/tasks/{options.task}/runs")
        if not runs:
            sys.exit(f"nothing was learned for task {options.task} yet; run 02_learn_over_rest.py first")
        job = station.call("POST", f"/paths/{runs[0]['learned']['paths'][0]['id']}/plans")
        while not job["finished_ns"]:
            time.sleep(0.1)
            job = station.call("GET", f"/jobs/{job['id']}")
        if job["state"] != "succeeded":
            sys.exit(f"the arm cannot follow this path: {job['message']}")
        certificate = station.call("GET", f"/plans/{job['outcome']}")["certificate"]
        for limit in ("velocity_use", "acceleration_use", "jerk_use", "clearance"):
            print(f"{limit:17} {certificate[limit]['value']:.3f} at {certificate[limit]['place']}")
        wanted = {"plan": job["outcome"], "override": options.override}
        execution = station.call("POST", "/executions", wanted)
        while (status := execution["status"])["state"] not in ENDED:
            print(f"{status['state']:12} {status['progress']:6.1%}", flush=True)
            time.sleep(0.5)
            execution = station.call("GET", f"/executions/{execution['id']}")
    print(f"{status['state']}: tracking error {status['tracking_error']:.4f} rad, {status['missed']} setpoints missed")
    if status["state"] == "faulted":
        sys.exit(f"the execution faulted: {status['reason']}")


if __name__ == "__main__":
    main()
