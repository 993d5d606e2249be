"""Drive a robot of your own: setpoints in, joint states out, in place of the simulated arm.

The contract is in proto/teachpath_proto/motion.proto. Put your controller into `Arm`; this one is wherever it was sent.
Start the service without the simulated arm, `TEACHPATH_SIMULATOR__START=false teachpath serve`, then:
    python 04_drive_a_robot.py [--endpoint tcp/127.0.0.1:7447]
"""

import argparse
import time
from collections import deque

from teachpath_client import Link
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role
from teachpath_proto.motion_pb2 import JointState, Setpoint

HOME = [0.365, 1.663, -3.177, 0.0, -1.628, 0.365]  # [rad]
DELAY = 30_000_000  # [ns] that every setpoint waits, so that one that was held up still comes in time
SILENCE = 50_000_000  # [ns] without one after which the arm says that it holds


class Arm:
    """Where your controller belongs."""

    def __init__(self) -> None:
        self.position, self.velocity = HOME, [0.0] * 6

    def send(self, setpoint: Setpoint) -> None:
        """Give the controller position and velocity, as feed-forward, and open or close the gripper."""
        self.position, self.velocity = list(setpoint.position), list(setpoint.velocity)


def main() -> None:
    """Apply each setpoint when it is due and publish the joint state a hundred times a second, until Ctrl-C."""
    parser = argparse.ArgumentParser(description="Drive a robot of your own.")
    parser.add_argument("--endpoint", default="tcp/127.0.0.1:7447")
    endpoint = parser.parse_args().endpoint
    keys, arm, waiting, newest, missed, told = Keys(), Arm(), deque[Setpoint](), Setpoint(), 0, 0
    with Link(endpoint, role=Role.ROBOT) as link:
        link.subscribe(keys.setpoint("puma560"), lambda payload: waiting.append(Setpoint.FromString(payload)))
        publisher = link.publisher(keys.state("puma560"))
        alive = link.announce(keys.alive("robot", "puma560"))
        while alive:
            while waiting and waiting[0].nominal_ns + DELAY <= time.time_ns():
                gap = waiting[0].cycle - newest.cycle - 1
                missed = missed + gap if waiting[0].execution == newest.execution else 0
                newest = waiting.popleft()
                arm.send(newest)
            if (now := time.time_ns()) - told >= 10_000_000:
                told, holding = now, now - newest.nominal_ns > DELAY + SILENCE
                state = JointState(stamp_ns=now, cycle=newest.cycle, execution=newest.execution, missed=missed)
                state.holding, state.gripper_closed, nothing = holding, newest.gripper_closed, [0.0] * 6
                state.MergeFrom(JointState(position=arm.position, velocity=nothing if holding else arm.velocity))
                state.MergeFrom(JointState(torque=nothing, object_position=nothing[:3], object_orientation=nothing[:4]))
                publisher.put(state.SerializeToString())
            time.sleep(0.001)


if __name__ == "__main__":
    main()
