"""What a plan may use of the arm, and how near it may come to things."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, Len


@dataclass(frozen=True)
class MotionSettings:
    """How paths are planned."""

    # arm that was added to the data folder (teachpath arm add), by its name; left out = the Puma 560
    arm: str | None = None
    # published table of the Puma 560; they differ in lengths (the arm's offset by 25 mm), inertia and friction
    variant: Literal["corke-armstrong", "armstrong-khatib-burdick", "fu-gonzalez-lee", "corke-1996"] = "corke-armstrong"
    # [m] from where the gripper sits to the tool centre point, which follows the path; what reaches beyond its fingers
    # (0.135) is checked for collisions as a rod 22 mm thick
    tool_length: Annotated[float, Ge(0.05), Le(0.5)] = 0.13
    # [m] tool centre point in the flange's frame, whose z is the axis of joint 6; left out = on that axis, tool_length
    # ahead. The gripper sits tool_length behind it, and what lies between flange and gripper is checked as a straight
    # adapter 40 mm thick
    tool_position: Annotated[tuple[Annotated[float, Ge(-0.5), Le(0.5)], ...], Len(3, 3)] | None = None
    # orientation of the tool in the flange's frame (w, x, y, z): its z points out of the gripper, along y the fingers
    # close; left out = as the flange
    tool_orientation: Annotated[tuple[Annotated[float, Ge(-1), Le(1)], ...], Len(4, 4)] | None = None
    # what takes the object: `parallel`, two fingers; `suction`, a cup that touches it from above; `none`: the tool
    # alone follows paths, in scenes without an object, and payload_mass says its mass; left out = parallel
    gripper: Literal["parallel", "suction", "none"] | None = None
    # [kg] of what the flange carries besides the gripper and the scene's object, e.g. a camera or another tool
    payload_mass: Annotated[float, Ge(0), Le(10)] = 0.0
    # [m] its centre of mass in the flange's frame: z along the axis of joint 6, y as the fingers close
    payload_center: Annotated[tuple[Annotated[float, Ge(-0.5), Le(0.5)], ...], Len(3, 3)] = (0.0, 0.0, 0.05)
    # [rad] the joints where the arm waits: elbow up, tool down, above the table
    home: Annotated[tuple[float, ...], Len(6, 7)] = (0.365, 1.663, -3.177, 0.0, -1.628, 0.365)
    # [m] that arm and carried object stay away from obstacles and the arm from itself
    clearance_min: Annotated[float, Ge(0)] = 0.005
    # [m] that the carried object may dip into what it stands on at its start
    contact_tolerance: Annotated[float, Ge(0), Le(0.02)] = 0.003
    # [m] by which the fingers overlap an object that they take, or all of one that is smaller
    grasp_depth: Annotated[float, Gt(0), Le(0.05)] = 0.01
    # [m] above start and goal, from where the gripper comes down straight; else nearer or from a side
    lift: Annotated[float, Gt(0), Le(0.5)] = 0.08
    # share of the joints' speed, acceleration and jerk limits that following a path may use
    path_share: Annotated[float, Gt(0), Le(1)] = 1.0
    # the same for moves to the path and away from it
    move_share: Annotated[float, Gt(0), Le(1)] = 0.5
    # [m/s] that elbow, wrist and tool centre point keep in all motion; 0.25 is the usual reduced speed with people near
    # the arm (ISO 10218-1, ISO/TS 15066); left out = as fast as the joints allow
    tool_speed: Annotated[float, Ge(0.01), Le(10)] | None = None
    # [rad] turns of the gripper about the vertical to try before it turns on the way; 0 closes the fingers along y
    rolls: Annotated[tuple[float, ...], Len(1)] = (0.0, 1.5707963267948966, 3.141592653589793, -1.5707963267948966)
    # `fixed`: the gripper points down all the way; `demonstrated`: it turns as the carried object was turned
    orientation: Literal["fixed", "demonstrated"] = "fixed"
    # least singular value of the Jacobian that still counts as away from singular poses
    least_singular: Annotated[float, Ge(0)] = 0.03
    # [m] the tool may be off the path between two nodes of its spline
    path_tolerance: Annotated[float, Gt(0)] = 0.0001
    # [m] between two nodes
    node_spacing: Annotated[float, Gt(0), Le(0.01)] = 0.002
    # [Hz] of the setpoints with which limits are checked
    rate: Annotated[float, Ge(50), Le(1000)] = 250.0
    # [days] that the certificate of a plan holds, from when it was made
    certificate_validity: Annotated[float, Gt(0), Le(3650)] = 30.0
