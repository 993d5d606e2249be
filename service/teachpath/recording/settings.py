"""The settings of recording."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Ge, Gt, Le

from teachpath.errors import UnusableSettings

Share = Annotated[float, Ge(0), Le(1)]
Positive = Annotated[float, Gt(0)]
Corner = tuple[float, float, float]


@dataclass(frozen=True)
class RecordingSettings:
    """How a stream of hand samples is cut and judged."""

    # mean flexion (0 open, 1 closed) above which an open hand counts as closed
    close_at: Share = 0.6
    # mean flexion below which a closed hand counts as open
    open_at: Share = 0.4
    # [m] how near the object's centre the hand must close to grasp it
    grasp_radius: Positive = 0.08
    # [m] how far a grasped object must be moved to count as carried
    lift: Positive = 0.01
    # [s] a hand that opens for less while it carries has not let go
    release_time: Positive = 0.1
    # [s] a hand that closes or opens for less has not: its glove flaps; one that closes again so soon after it let go
    # has not put the object down where it is said to be
    shortest_grip: Positive = 0.3
    # flaps of a glove while the hand carries, more of which reject a demonstration
    most_flaps: Annotated[int, Ge(0)] = 2
    # [s] how long the open hand must rest to end a demonstration
    rest_time: Positive = 0.3
    # [m] how far it may move while it rests
    rest_motion: Positive = 0.01
    # [s] after the release a demonstration ends even without rest
    longest_return: Positive = 3.0
    # [s] a reach longer than this starts the recording anew
    longest_reach: Positive = 60.0
    # samples: a shorter transport phase is no demonstration
    shortest_transport: Annotated[int, Ge(5)] = 20
    # share of the samples from grasp to release that may be lost, refused, untracked, in conflict, jumping, swinging
    # back and forth or out of the workspace before a demonstration is rejected
    largest_loss: Share = 0.05
    # [s] longest gap in the device's clock from grasp to release before it is rejected
    longest_gap: Positive = 0.25
    # [s] longest time for which the tracker may repeat one reading while the hand carries before it is rejected
    longest_freeze: Positive = 0.1
    # [Hz] readings that differ, from grasp to release; a tracker that measures more rarely than that is rejected
    lowest_pose_rate: Positive = 20.0
    # [m] lowest corner of the workspace, world; a hand that transports outside it is counted as a fault
    workspace_low: Corner = (-1.5, -1.5, -0.5)
    # [m] its highest corner
    workspace_high: Corner = (1.5, 1.5, 2.5)
    # [m] how far a taught point of a calibration may lie from where the others put it
    largest_residual: Positive = 0.02
    # [m] a position farther than this from where its neighbours put it has jumped
    largest_jump: Positive = 0.05
    # [m/s^2] a hand that turns back by over `largest_jump` cannot do it faster than this
    largest_acceleration: Positive = 50.0
    # share by which the rate may differ from the one that the client declared
    rate_tolerance: Share = 0.1
    # [s] a step of the device's clock that neither the numbers nor our clock explain is a clock jump
    largest_clock_step: Positive = 0.1
    # [s] a tracker that is silent for longer in mid-take is lost
    longest_silence: Positive = 2.0
    # [s] from the service's start, in which the tracker of a recording that was running at the stop has to come back
    tracker_return_timeout: Positive = 30.0
    # [s] counted down before each take, unless a recording says otherwise
    countdown: Annotated[float, Ge(0), Le(60)] = 0.0
    # [s] a fist held still for so long, away from the object, pauses or resumes as it opens; held three times as long
    # it discards the last demonstration; 0: a fist says nothing
    fist_time: Annotated[float, Ge(0)] = 1.0
    # mean flexion above which a hand is a fist
    fist_at: Share = 0.8
    # [m] least distance of such a fist from the object's centre
    fist_distance: Positive = 0.2
    # [m] how far it may move
    fist_motion: Positive = 0.05
    # samples of one tracker that may wait to be recorded; more are turned away, and said to be
    longest_backlog: Annotated[int, Ge(100)] = 50_000
    # [s] how long the handshake at the end waits for samples that are still under way
    handshake_timeout: Positive = 2.0

    def __post_init__(self) -> None:
        if not self.open_at < self.close_at:
            raise UnusableSettings(
                f"recording.open_at is {self.open_at:g}; it must be under close_at, {self.close_at:g}, or the hand "
                "would flicker between open and closed"
            )
        if not self.close_at <= self.fist_at:
            raise UnusableSettings(
                f"recording.fist_at is {self.fist_at:g}; it must not be under close_at, {self.close_at:g}"
            )
        for axis, low, high in zip("xyz", self.workspace_low, self.workspace_high, strict=True):
            if not low < high:
                raise UnusableSettings(
                    f"recording.workspace_low is {low:g} in {axis}; it must be under workspace_high, {high:g}"
                )
