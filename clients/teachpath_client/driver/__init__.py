"""What a driver of an arm needs: the player that makes one smooth and safe motion of setpoints, and its messages."""

from teachpath_client.driver.messages import Setpoint, decode_setpoint, joint_state
from teachpath_client.driver.player import PlayerState, SetpointLike, SetpointPlayer, TargetMotion

__all__ = [
    "PlayerState",
    "Setpoint",
    "SetpointLike",
    "SetpointPlayer",
    "TargetMotion",
    "decode_setpoint",
    "joint_state",
]
