"""Signs the certificates of plans with a station's key, and checks such a signature."""

from __future__ import annotations

import hmac
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any, Final

from teachpath.errors import PathRefused, UnusableInput
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.tool import describe_tool
from teachpath.motion.planning.canonical import canonical
from teachpath.motion.planning.digest import verify
from teachpath.motion.settings import MotionSettings
from teachpath.records import Calibration, Plan, Signature

MIN_KEY_LENGTH: Final = 32  # [bytes], as long as the hash
DAY_NS: Final = 86_400 * 10**9
CLOCK_TOLERANCE_NS: Final = 60 * 10**9  # by which the clock of another machine may be behind
VALIDITY: Final = "certificate_validity"  # the setting that changes no motion


@dataclass(frozen=True, slots=True)
class SigningKey:
    """The secret of a station, which signs its plans; it is not shown.

    Raises:
        UnusableInput: it is too short.
    """

    secret: bytes = field(repr=False)

    def __post_init__(self) -> None:
        if len(self.secret) < MIN_KEY_LENGTH:
            raise UnusableInput(f"a signing key of {len(self.secret)} bytes is too short; it has {MIN_KEY_LENGTH}")


@dataclass(frozen=True, slots=True)
class CalibrationScope:
    """The calibrations for which a certificate holds: of the path's demonstrations, and of the same names today."""

    recorded: tuple[Calibration, ...] = ()
    present: tuple[Calibration, ...] = ()


def sign_plan(
    plan: Plan,
    arm: Arm,
    settings: MotionSettings,
    key: SigningKey,
    *,
    issued_ns: int,
    calibrations: CalibrationScope = CalibrationScope(),
) -> Plan:
    """Sign a plan that was just made: HMAC-SHA256 over all of it, its certificate, the arm and the settings.

    Args:
        plan: certified for `arm` under `settings`.
        arm: that it is for.
        settings: with which it was made; they say for how long the certificate holds.
        key: of the station.
        issued_ns: present time [ns since the Unix epoch].
        calibrations: of the demonstrations that the path was learned from.

    Raises:
        PathRefused: the plan is not the one that was certified.
    """
    verify(plan, arm)
    signature = Signature(
        arm=arm.identity,
        tool_length=arm.tool_length,
        settings=certified_settings(settings),
        calibrations=calibrations.recorded,
        present_calibrations=calibrations.present,
        issued_ns=issued_ns,
        expires_ns=issued_ns + round(settings.certificate_validity * DAY_NS),
        mac="",
        tool=arm.tool,
    )
    unsigned = _with_signature(plan, signature)
    return _with_signature(plan, replace(signature, mac=_mac(unsigned, arm, key)))


def verify_signature(plan: Plan, arm: Arm, settings: MotionSettings, key: SigningKey, now_ns: int) -> None:
    """Check that this station signed a plan, for this arm and these settings, and that the certificate still holds.

    Raises:
        PathRefused: it does not; the sentence says which of them, and the way out.
    """
    signature = plan.certificate.signature
    if signature is None:
        raise PathRefused(
            f"plan {plan.id} is not signed: it was made outside a station, or before stations signed their plans; "
            "plan the path again at this station"
        )
    # What it says it holds for is compared first, because another arm has another code, and the difference has a name.
    _check_arm(plan.id, signature, arm)
    _check_settings(plan.id, signature, settings)
    unsigned = _with_signature(plan, replace(signature, mac=""))
    if not hmac.compare_digest(_mac(unsigned, arm, key).encode(), signature.mac.encode()):
        raise PathRefused(
            f"the signature of plan {plan.id} is not one of this station's: the plan or its certificate was changed, "
            "or another station (another signing key) made it; plan the path again at this station"
        )
    verify(plan, arm)
    check_validity(plan, now_ns)


def certified_arm(plan: Plan, present: Arm | None = None) -> Arm | None:
    """Return the arm that the signature of a plan says it is for; the present one where the plan is not signed.

    Raises:
        PathRefused: it is an arm that was added, and the present one is another.
    """
    signature = plan.certificate.signature
    if signature is None:
        return present
    if signature.settings.get("arm") is not None:
        if present is None or present.identity != signature.arm:
            here = "none is given" if present is None else f"the arm here is {present.identity}"
            raise PathRefused(
                f"plan {plan.id} is for {signature.arm}, and {here}; set motion.arm to the arm of the plan"
            )
        return present
    known = {field.name for field in fields(MotionSettings)}
    return Arm.of_settings(
        MotionSettings(**{name: signature.settings[name] for name in known & set(signature.settings)})
    )


def check_validity(plan: Plan, now_ns: int) -> None:
    """Check that the certificate of a signed plan has not expired; raises PathRefused."""
    signature = plan.certificate.signature
    assert signature is not None
    if now_ns >= signature.expires_ns:
        days = (now_ns - signature.expires_ns) / DAY_NS
        lasted = (signature.expires_ns - signature.issued_ns) / DAY_NS
        raise PathRefused(
            f"the certificate of plan {plan.id} expired {days:.2f} days ago, it held for {lasted:g} days "
            "(motion.certificate_validity); plan the path again"
        )
    if now_ns < signature.issued_ns - CLOCK_TOLERANCE_NS:
        ahead = (signature.issued_ns - now_ns) / 1e9
        raise PathRefused(
            f"the certificate of plan {plan.id} was issued {ahead:.0f} s after the present time; set this machine's "
            "clock right, or plan the path again"
        )


def certified_settings(settings: MotionSettings) -> dict[str, Any]:
    """Return the settings on which a plan and its execution depend, by name."""
    return {name: value for name, value in asdict(settings).items() if name != VALIDITY}


def _check_arm(plan: str, signature: Signature, arm: Arm) -> None:
    if (signature.arm, signature.tool_length, signature.tool) != (arm.identity, arm.tool_length, arm.tool):
        raise PathRefused(
            f"the certificate of plan {plan} holds for the {signature.arm} with "
            f"{describe_tool(signature.tool, signature.tool_length)}, and this arm is the {arm.identity} with "
            f"{describe_tool(arm.tool, arm.tool_length)} (motion.arm, variant, tool_length, tool_position, "
            "tool_orientation); plan the path again for this arm"
        )


def _check_settings(plan: str, signature: Signature, settings: MotionSettings) -> None:
    present: Mapping[str, Any] = certified_settings(settings)
    for name in sorted(present.keys() | signature.settings.keys()):
        was, now = signature.settings.get(name), present.get(name)
        if canonical(was) != canonical(now):
            raise PathRefused(
                f"the certificate of plan {plan} holds for motion.{name} = {_text(was)}, and it is {_text(now)} now; "
                "plan the path again, or set it back"
            )


def _text(value: object) -> str:
    return str(list(value) if isinstance(value, tuple) else value)


def _with_signature(plan: Plan, signature: Signature) -> Plan:
    return replace(plan, certificate=replace(plan.certificate, signature=signature))


def _mac(unsigned: Plan, arm: Arm, key: SigningKey) -> str:
    return hmac.new(key.secret, canonical([unsigned, arm]), "sha256").hexdigest()
