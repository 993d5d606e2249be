"""A signature holds for exactly what was signed: every change of a plan, and everything it does not hold for."""

import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teachpath.errors import PathRefused, TeachpathError, UnusableInput
from teachpath.io.documents import decode, encode
from teachpath.motion.arm.model import Arm
from teachpath.motion.arm.puma560 import VARIANTS
from teachpath.motion.collision.builtin_scenes import paper_scene
from teachpath.motion.planning.canonical import canonical
from teachpath.motion.planning.digest import digest
from teachpath.motion.planning.plan import plan as make_plan
from teachpath.motion.planning.signature import DAY_NS, CalibrationScope, SigningKey, sign_plan, verify_signature
from teachpath.motion.settings import MotionSettings
from teachpath.records import Calibration, Plan
from tests.unit.executor.executors import ARM, EPOCH, KEY
from tests.unit.motion.ways import MIDDLE, way

SETTINGS = MotionSettings()
Place = tuple[str | int, ...]


@pytest.fixture(scope="module")
def plan(middle: Plan) -> Plan:
    """A signed plan of few numbers: all of them can be changed, one after the other."""
    rows = slice(3)
    few = replace(
        middle,
        lengths=middle.lengths[rows],
        joints=middle.joints[rows],
        squared_rates=middle.squared_rates[rows],
        author="ada",
    )
    certified = replace(few, certificate=replace(few.certificate, digest=digest(few, ARM)))
    lab = Calibration("lab@1", scale=0.5, offset=(0.1, 0.2, 0.3))
    scope = CalibrationScope((lab,), (replace(lab, name="lab@2"),))
    return sign_plan(certified, ARM, SETTINGS, KEY, issued_ns=EPOCH, calibrations=scope)


def refusal(
    plan: Plan, *, arm: Arm = ARM, settings: MotionSettings = SETTINGS, key: SigningKey = KEY, now: int = EPOCH
) -> str:
    with pytest.raises(PathRefused) as refused:
        verify_signature(plan, arm, settings, key, now)
    assert "plan the path again" in str(refused.value)
    assert plan.id in str(refused.value)
    return str(refused.value)


# every change


def leaves(document: Any, place: Place = ()) -> Iterator[tuple[Place, Any]]:
    """Yield the place and the value of everything in a JSON document that holds nothing itself, and of empty lists."""
    inside = document.items() if isinstance(document, dict) else enumerate(document)
    for key, value in inside:
        if isinstance(value, dict | list) and value:
            yield from leaves(value, (*place, key))
        else:
            yield (*place, key), value


def changed(value: Any) -> Any:
    """Return the nearest other value of the kind: a number's last bit flipped."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return float(np.nextafter(value, np.inf))
    return f"{value}x" if isinstance(value, str) else "x"


def with_value(text: bytes, place: Place, value: Any) -> bytes:
    document = json.loads(text)
    inner = document
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    return json.dumps(document).encode()


def is_refused(text: bytes) -> bool:
    try:
        verify_signature(decode(Plan, text), ARM, SETTINGS, KEY, EPOCH)
    except TeachpathError as error:
        return "plan" in str(error).lower()
    return False


def test_every_single_change_of_a_signed_plan_is_refused(plan: Plan) -> None:
    text = encode(plan)
    assert not is_refused(text)
    places = list(leaves(json.loads(text)))
    assert {place[0] for place, _ in places} == set(json.loads(text))  # no field is left out
    accepted = [place for place, value in places if not is_refused(with_value(text, place, changed(value)))]
    assert accepted == []


def test_for_whom_it_was_made_is_signed_and_changes_no_digest(plan: Plan) -> None:
    others = replace(plan, author="bob")
    assert digest(others, ARM) == plan.certificate.digest
    assert "not one of this station's" in refusal(others)


def test_whatever_people_call_its_scene_a_plan_is_the_same() -> None:
    one, other = (replace(paper_scene(), display_name=name) for name in ("", "Halle 3 (Süd)"))
    assert encode(make_plan(way(MIDDLE), one)) == encode(make_plan(way(MIDDLE), other))


@given(st.data())
def test_rows_cannot_be_left_out_doubled_or_exchanged(plan: Plan, data: st.DataObject) -> None:
    text = encode(plan)
    document = json.loads(text)
    name = data.draw(st.sampled_from(["lengths", "joints", "squared_rates", "limits", "above_start", "above_goal"]))
    rows = data.draw(st.lists(st.sampled_from(document[name]), max_size=len(document[name]) + 1))
    assert (rows == document[name]) != is_refused(with_value(text, (name,), rows))


Values = st.recursive(
    st.none() | st.booleans() | st.text(max_size=3) | st.integers() | st.floats(allow_nan=False),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=2), inner, max_size=3),
)


@given(Values, Values)
def test_different_values_have_different_encodings(one: Any, other: Any) -> None:
    assert (canonical(one) == canonical(other)) == (canonical(json.loads(json.dumps(one))) == canonical(other))
    if canonical(one) == canonical(other):
        assert one == other


# what it holds for


def test_a_plan_without_a_signature_is_refused(plan: Plan) -> None:
    unsigned = replace(plan, certificate=replace(plan.certificate, signature=None))
    assert "is not signed" in refusal(unsigned)


def test_a_digest_that_was_computed_again_helps_nobody(plan: Plan) -> None:
    faster = replace(plan, squared_rates=4.0 * plan.squared_rates)
    forged = replace(faster, certificate=replace(faster.certificate, digest=digest(faster, ARM)))
    assert "not one of this station's" in refusal(forged)


def test_a_plan_of_another_station_is_refused(plan: Plan) -> None:
    assert "another station" in refusal(plan, key=SigningKey(bytes(range(1, 33))))


@pytest.mark.parametrize(
    "arm",
    [Arm.of_variant(name) for name in VARIANTS if name != ARM.name]
    + [replace(ARM, tool_length=ARM.tool_length + 0.01)],
    ids=lambda arm: f"{arm.name} {arm.tool_length:g}",
)
def test_another_arm_is_refused_by_its_name(plan: Plan, arm: Arm) -> None:
    said = refusal(plan, arm=arm)
    assert f"holds for the {ARM.name}" in said
    assert f"{1e3 * arm.tool_length:g} mm" in said


def test_an_arm_of_the_same_name_with_other_links_is_refused(plan: Plan) -> None:
    link = ARM.links[2]
    heavier = replace(ARM, links=(*ARM.links[:2], replace(link, mass=2.0 * link.mass), *ARM.links[3:]))
    assert "not one of this station's" in refusal(plan, arm=heavier)


def test_settings_that_have_changed_are_named(plan: Plan) -> None:
    wider = replace(SETTINGS, clearance_min=0.02)
    assert "holds for motion.clearance_min = 0.005, and it is 0.02 now" in refusal(plan, settings=wider)
    slower = replace(SETTINGS, tool_speed=0.25)
    said = refusal(plan, arm=Arm.of_settings(slower), settings=slower)
    assert "holds for motion.tool_speed = None, and it is 0.25 now" in said
    verify_signature(plan, ARM, replace(SETTINGS, certificate_validity=1.0), KEY, EPOCH)  # of plans to come


def test_a_certificate_holds_from_its_issue_to_its_expiry(plan: Plan) -> None:
    signature = plan.certificate.signature
    assert signature is not None
    assert signature.expires_ns == EPOCH + 30 * DAY_NS
    verify_signature(plan, ARM, SETTINGS, KEY, signature.expires_ns - 1)
    assert "expired 0.00 days ago, it held for 30 days" in refusal(plan, now=signature.expires_ns)
    assert "set this machine's clock right" in refusal(plan, now=EPOCH - 3600 * 10**9)


def test_what_was_not_certified_is_not_signed(plan: Plan) -> None:
    with pytest.raises(PathRefused, match="changed since it was certified"):
        sign_plan(replace(plan, squared_rates=2.0 * plan.squared_rates), ARM, SETTINGS, KEY, issued_ns=EPOCH)


def test_a_key_is_not_shown_and_not_short() -> None:
    assert repr(KEY) == "SigningKey()"
    with pytest.raises(UnusableInput, match="31 bytes is too short"):
        SigningKey(bytes(31))
