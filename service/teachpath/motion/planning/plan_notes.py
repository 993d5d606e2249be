"""What whoever takes a plan elsewhere must know of it: the arm, the limits, what was proved, and what was not."""

from __future__ import annotations

import numpy as np

from teachpath.lengths import describe_length
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.object_mass import object_mass
from teachpath.motion.arm.tool import describe_tool
from teachpath.records import Array, Certificate, Plan, Posture, Signature, ToolOutput


def plan_notes(plan: Plan, arm: Arm) -> tuple[str, ...]:
    """Say what a plan's motion is, what its certificate proved, and what it does not cover; one sentence each."""
    length = describe_length(float(plan.lengths[-1]), digits=3)
    carried = plan.scene.carried
    return (
        f"Plan {plan.id}: path {plan.path}, version {plan.path_version}, {length} in {plan.duration:.3f} s.",
        "It is the motion along the learned path alone, from rest to rest, with the gripper closed"
        + (f" on {carried.name}, {object_mass(carried):.3g} kg" if carried else "")
        + "; the way to its start, grasp, release and the way home are not in it.",
        *arm_notes(arm),
        f"Limits of the joints, from the base: {_listed(plan.limits[0])} rad/s; {_listed(plan.limits[1])} rad/s^2; "
        f"{_listed(plan.limits[2])} rad/s^3.",
        _proved(plan, plan.certificate),
        *([_near_shown(plan.posture)] if plan.posture else []),
        *([_output(plan.output)] if plan.output else []),
        *([_scope(plan.certificate.signature)] if plan.certificate.signature else []),
        "Not covered: another arm, tool, payload or scene; the way to the first point; what a controller does between "
        "the points, as blending, filters and overrides; a tool or object held in another place.",
        "Nobody has tried this file on a real controller: run it slowly first, with the emergency stop in reach.",
    )


def arm_notes(arm: Arm) -> tuple[str, ...]:
    """Say whose joints a motion has, and how they are counted; one sentence each."""
    payload = f", {arm.payload.mass:g} kg besides" if arm.payload.mass else ""
    tool = f"{describe_length(arm.tool_length, digits=3)} from flange to tool centre point"
    if arm.tool is not None:
        orientation = _listed(np.array(arm.tool.orientation))
        tool = f"{describe_tool(arm.tool, arm.tool_length)} (orientation w x y z {orientation})"
    if arm.model is not None:
        return (
            f"Arm: {arm.identity}, tool {tool}{payload}.",
            f"Joints in this order, from the base: {', '.join(joint.name for joint in arm.model.joints)}; their angles "
            "and zeros are those of its model.",
        )
    return (
        f"Arm: Puma 560 ({arm.name}), {tool}{payload}.",
        "Joints 1 to 6 in this order, from the base: standard Denavit-Hartenberg angles, zero position of Paul.",
    )


def _proved(plan: Plan, certificate: Certificate) -> str:
    uses = {
        "position": certificate.position_use,
        "speed": certificate.velocity_use,
        "acceleration": certificate.acceleration_use,
        "jerk": certificate.jerk_use,
        "torque": certificate.torque_use,
    }
    shares = ", ".join(f"{name} {use.value:.1%}" for name, use in uses.items())
    near = certificate.clearance
    clearance = f"; {describe_length(near.value)} clear ({near.place})" if np.isfinite(near.value) else ""
    return (
        f"Certificate {certificate.digest[:16]} proved, for this arm in scene {plan.scene.name}: limits used to at "
        f"most {shares}{clearance}."
    )


def _near_shown(posture: Posture) -> str:
    away = f"{np.degrees(posture.distance.value):.1f} deg ({posture.distance.place})"
    return f"It keeps within {away} of the joints that demonstration {posture.demonstration} showed."


def _output(output: ToolOutput) -> str:
    return (
        f"Output {output.name} is to be on along the path, with {output.start:g} s of rest before it and "
        f"{output.end:g} s behind it; it is not in this file: switch it in your program."
    )


def _scope(signature: Signature) -> str:
    issued, expires = (
        f"{np.datetime_as_string(np.datetime64(ns, 'ns'), unit='m').replace('T', ' ')} UTC"
        for ns in (signature.issued_ns, signature.expires_ns)
    )
    return f"It was signed {issued} by the station that made it, and holds until {expires} unless it is revoked."


def _listed(values: Array) -> str:
    return " ".join(f"{value:.4g}" for value in values)
