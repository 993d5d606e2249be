"""Which joints of a model are those of the arm: a chain from the base to the tool."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import mujoco
import numpy as np

from teachpath.errors import UnusableInput
from teachpath.io.arm_models.model_file import ModelFile

HINGE: Final = int(mujoco.mjtJoint.mjJNT_HINGE)
SLIDE: Final = int(mujoco.mjtJoint.mjJNT_SLIDE)
JOINT_COUNTS: Final = (6, 7)
TOOL_FRAMES: Final = ("tool0", "tcp", "tool_center_point", "attachment_site", "flange")  # first in this order


@dataclass(frozen=True)
class Chain:
    """The arm's joints in a model, and its tool.

    Attributes:
        joints: their numbers in the model, from the base to the tool.
        tool_body: that carries the tool.
        tool_site: of `tool_body`, where the tool is; None: the body's own frame.
    """

    joints: tuple[int, ...]
    tool_body: int
    tool_site: int | None = None


def joint_name(model: mujoco.MjModel, joint: int) -> str:
    """Return the name of a joint, or its number where it has none."""
    return str(model.joint(joint).name) or f"number {joint + 1}"


def last_joint(model: mujoco.MjModel, body: int) -> int | None:
    """Return the joint that moves a body: its own last one, or that of the nearest body before; None: it is fixed."""
    while body:
        if count := int(model.body_jntnum[body]):
            return int(model.body_jntadr[body]) + count - 1
        body = int(model.body_parentid[body])
    return None


def joint_before(model: mujoco.MjModel, joint: int) -> int | None:
    """Return the joint that comes before one on the way from the base."""
    body = int(model.jnt_bodyid[joint])
    if joint > int(model.body_jntadr[body]):
        return joint - 1
    return last_joint(model, int(model.body_parentid[body]))


def joints_to(model: mujoco.MjModel, joint: int | None) -> tuple[int, ...]:
    """Return the joints from the base to one, itself included."""
    way = []
    while joint is not None:
        way.append(joint)
        joint = joint_before(model, joint)
    return tuple(reversed(way))


def find_chain(file: ModelFile, tool: str | None) -> Chain:
    """Find the arm's joints.

    Args:
        file: the model.
        tool: name of the body or site that is the tool; None: where the only chain of revolute joints ends.

    Raises:
        UnusableInput: several arms end in the model, none does, or its joints are not those of a chain that is planned.
    """
    model = file.model
    chain = _named(file, tool) if tool else _only(file)
    if len(chain.joints) not in JOINT_COUNTS:
        names = ", ".join(joint_name(model, joint) for joint in chain.joints)
        raise UnusableInput(
            f"{file.path}: the arm has {len(chain.joints)} joints ({names}); arms of 6 and of 7 are planned; "
            "name the body or site where it ends with --tool"
        )
    for joint in chain.joints:
        _check_joint(file, joint)
    _check_loops(file, chain)
    return chain


def _named(file: ModelFile, tool: str) -> Chain:
    model = file.model
    site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, tool)
    body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, tool) if site < 0 else int(model.site_bodyid[site])
    if body < 0:
        frames = [model.body(k).name for k in range(1, model.nbody)] + [model.site(k).name for k in range(model.nsite)]
        raise UnusableInput(f"{file.path} has no body or site {tool!r} for the tool; known: {', '.join(frames)}")
    return Chain(joints_to(model, last_joint(model, body)), body, None if site < 0 else site)


def _only(file: ModelFile) -> Chain:
    """Return the chain of an arm alone in its model; sliding fingers at its end are no part of it."""
    model = file.model
    inner = {joint_before(model, joint) for joint in range(model.njnt)}
    ways = {joints_to(model, joint) for joint in range(model.njnt) if joint not in inner}
    ways = {_without_fingers(file, way) for way in ways}
    longest = max(ways, key=len)
    if any(way != longest[: len(way)] for way in ways):
        ends = sorted(str(model.body(int(model.jnt_bodyid[way[-1]])).name) for way in ways if way)
        raise UnusableInput(f"{file.path} has {len(ends)} arms, which end in {', '.join(ends)}; name one with --tool")
    body = int(model.jnt_bodyid[longest[-1]]) if longest else 0
    return _with_tool_frame(model, Chain(longest, body))


def _without_fingers(file: ModelFile, way: tuple[int, ...]) -> tuple[int, ...]:
    while way and (int(file.model.jnt_type[way[-1]]) == SLIDE or _mimicked(file, way[-1])):
        way = way[:-1]
    return way


def _with_tool_frame(model: mujoco.MjModel, chain: Chain) -> Chain:
    """Take the first of `TOOL_FRAMES` that is fixed to the last link; else the last link's own frame is the tool."""
    for name in TOOL_FRAMES:
        site = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_SITE, name)
        body = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) if site < 0 else int(model.site_bodyid[site])
        if body >= 0 and chain.joints and last_joint(model, body) == chain.joints[-1]:
            return Chain(chain.joints, body, None if site < 0 else site)
    return chain


def _mimicked(file: ModelFile, joint: int) -> str | None:
    """Return which joint a joint follows; None: it follows none."""
    model = file.model
    if (name := model.joint(joint).name) in file.urdf_joints:
        return file.urdf_joints[name].mimics
    for eq in np.flatnonzero(model.eq_type == int(mujoco.mjtEq.mjEQ_JOINT)):
        if joint == int(model.eq_obj1id[eq]):
            other = int(model.eq_obj2id[eq])
            return "a constant" if other < 0 else joint_name(model, other)
    return None


def _check_joint(file: ModelFile, joint: int) -> None:
    name = joint_name(file.model, joint)
    if int(file.model.jnt_type[joint]) != HINGE:
        kind = mujoco.mjtJoint(int(file.model.jnt_type[joint])).name.removeprefix("mjJNT_").lower()
        raise UnusableInput(
            f"{file.path}: joint {name} is a {kind} joint; arms of revolute joints are planned: fix it in the model, "
            "or end the arm before it with --tool"
        )
    if reference := float(file.model.qpos0[file.model.jnt_qposadr[joint]]):
        raise UnusableInput(
            f"{file.path}: joint {name} has ref {reference:g}; angles count from where the model stands: write ref 0 "
            "and move the range by it"
        )
    if other := _mimicked(file, joint):
        raise UnusableInput(
            f"{file.path}: joint {name} mimics {other}; joints of an arm move each by itself: fix it in the model, or "
            "end the arm before it with --tool"
        )


def _check_loops(file: ModelFile, chain: Chain) -> None:
    model = file.model
    loops = [int(mujoco.mjtEq.mjEQ_CONNECT), int(mujoco.mjtEq.mjEQ_WELD)]
    for eq in np.flatnonzero(np.isin(model.eq_type, loops)):
        if model.eq_objtype[eq] != int(mujoco.mjtObj.mjOBJ_BODY):
            one, two = (int(model.site_bodyid[k]) for k in (model.eq_obj1id[eq], model.eq_obj2id[eq]))
        else:
            one, two = int(model.eq_obj1id[eq]), int(model.eq_obj2id[eq])
        ends = [set(joints_to(model, last_joint(model, body))) & set(chain.joints) for body in (one, two)]
        if ends[0] != ends[1]:
            raise UnusableInput(
                f"{file.path}: {model.body(one).name} and {model.body(two).name} are tied together by an <equality>, a "
                "closed loop; only chains are planned: take it out of the model where the joints do without"
            )
