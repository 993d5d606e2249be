"""Drive a robot of your own: setpoints in, joint states out, in place of the simulated arm.

The contract is in proto/teachpath_proto/teachpath/v1/motion.proto; the player keeps it. Put your controller into `Arm`;
this one is wherever it was sent. Start the service without the simulated arm,
`TEACHPATH_SIMULATOR__START=false teachpath serve`:

    python 04_drive_a_robot.py [--endpoint tcp/127.0.0.1:7447]
"""

import argparse
import time
from collections import deque
from contextlib import suppress

from teachpath_client import Link
from teachpath_client.driver import SetpointPlayer, TargetMotion, decode_setpoint, joint_state
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role

HOME = [0.365, 1.663, -3.177, 0.0, -1.628, 0.365]  # [rad]


class Arm:
    """Where your controller belongs."""

    position, velocity = HOME, [0.0] * 6  # as measured [rad, rad/s]

    def send(self, target: TargetMotion) -> None:
        """Give the controller position, velocity and acceleration, as feed-forward."""
        self.position, self.velocity = target.position.tolist(), target.velocity.tolist()


def main() -> None:
    """Play the setpoints in steps of a millisecond and publish the joint state a hundred times a second."""
    parser = argparse.ArgumentParser(description="Drive a robot of your own.")
    parser.add_argument("--endpoint", default="tcp/127.0.0.1:7447")
    keys, arm, came, steps = Keys(), Arm(), deque[bytes](), 0
    player, before = SetpointPlayer(HOME), time.time_ns()
    with Link(parser.parse_args().endpoint, role=Role.ROBOT) as link:
        link.subscribe(keys.setpoint("puma560"), came.append)
        publisher, alive = link.publisher(keys.state("puma560")), link.announce(keys.alive("robot", "puma560"))
        while alive:
            while came:
                with suppress(ValueError):  # a malformed setpoint is left out
                    player.add(decode_setpoint(came.popleft()), time.time_ns())
            now, steps = time.time_ns(), steps + 1
            player.advance((now - before) / 1e9, now)
            before = now
            arm.send(player.target)
            if steps % 10 == 0:
                publisher.put(joint_state(player, arm.position, arm.velocity))
            time.sleep(0.001)


if __name__ == "__main__":
    main()
