"""Plans that may not move the arm, sent to the executor of real processes by every way in: the arm does not move."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

from teachpath.errors import PathRefused, TeachpathError
from teachpath.io.bus import Bus, BusSettings, open_bus
from teachpath.io.documents import decode, encode
from teachpath.io.signing_key import signing_key_path
from teachpath.io.wire import decode_setpoint, decode_state, decode_status, encode_command
from teachpath.motion.arm.model import Arm
from teachpath.motion.planning.digest import digest
from teachpath.motion.planning.signature import DAY_NS, SigningKey, sign_plan
from teachpath.motion.settings import MotionSettings
from teachpath.records import Certificate, Command, ExecutorStatus, ObjectPose, Plan, Scene, Signature
from teachpath_client import ClientError, Link, Tracker
from teachpath_client.errors import JobFailed
from teachpath_proto.control import CommandVerb
from teachpath_proto.keys import Keys
from teachpath_proto.logins import Role, find_login
from tests.system.processes import Service, run
from tests.system.test_station import FAST_RATE, shown
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

ARM = Arm.of_variant()
KEYS = Keys()
TASK = "forged"
STILL_TOLERANCE = 1e-3  # [rad] that an arm at rest gives way
LAB = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]  # places that its frame was taught by


class Attacker:
    """A program with the login of an operator, straight on the bus, that also sees all that the arm is sent."""

    def __init__(self, bus: Bus) -> None:
        self._bus = bus
        self.setpoints: list[np.ndarray] = []
        self.positions: list[np.ndarray] = []
        self.statuses: list[bytes] = []
        bus.subscribe(KEYS.setpoint("puma560"), lambda _, p: self.setpoints.append(decode_setpoint(p).position))
        bus.subscribe(KEYS.state("puma560"), lambda _, p: self.positions.append(decode_state(p).position))
        bus.subscribe(KEYS.executor_status, lambda _, payload: self.statuses.append(payload))
        wait_until(lambda: self.positions and self.statuses, "arm and executor speak")

    def start(self, plan: Plan, name: str = "execution-attack") -> ExecutorStatus:
        command = Command(CommandVerb.START, name, plan=encode(plan))
        return decode_status(self._bus.ask(KEYS.executor_command, encode_command(command), timeout=HANG))

    def stop(self) -> None:
        self._bus.ask(KEYS.executor_stop, encode_command(Command(CommandVerb.STOP)), timeout=HANG)

    def serve_certificates(self) -> None:
        """Say that every certificate holds, whether anybody may hear it or not."""
        self._bus.serve(KEYS.station_certificate, lambda query: query)


@contextmanager
def attacker(service: Service) -> Iterator[Attacker]:
    """Join the bus as an operator; while it lasts, the arm does not move."""
    bus = open_bus(BusSettings(endpoint=service.endpoint), find_login(service.endpoint, Role.OPERATOR))
    try:
        one = Attacker(bus)
        yield one
        seen = len(one.positions)
        wait_until(lambda: len(one.positions) > seen + 20, "the arm speaks on")
        assert one.setpoints == []
        assert np.ptp(one.positions, axis=0).max() < STILL_TOLERANCE
    finally:
        bus.close()


def learn_and_plan(service: Service) -> list[Plan]:
    """Return two plans of a path that was shown under a measured calibration."""
    measure(service, 0.0)
    with Link(service.endpoint) as link:
        tracker = Tracker(link, "glove")
        tracker.start(TASK, scene="paper", calibration="lab")
        tracker.publish(shown(12), speed=FAST_RATE)
        tracker.stop()
    for path in service.station.learn(TASK).learned.paths:
        with suppress(JobFailed):  # not every way leads past the obstacles
            return [stored(service, service.station.plan(path.id).id) for _ in range(2)]
    raise AssertionError("no path can be followed")


def measure(service: Service, offset: float) -> None:
    """Measure the calibration of the glove: its frame is the world's, moved along x [m]."""
    points = [{"tracker": place, "world": [place[0] + offset, *place[1:]]} for place in LAB]
    request(service, "PUT", "/calibrations/lab", {"points": points})


def request(service: Service, method: str, place: str, body: Any = None) -> httpx.Response:
    url = f"{service.url}/api/v1{place}"
    return httpx.request(method, url, json=body, timeout=HANG, trust_env=False).raise_for_status()


def stored(service: Service, plan: str) -> Plan:
    return decode(Plan, request(service, "GET", f"/plans/{plan}").content)


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    with Service(tmp_path_factory.mktemp("station") / "data") as service:
        yield service


@pytest.fixture(scope="module")
def plans(service: Service) -> list[Plan]:
    return learn_and_plan(service)


def certified(plan: Plan, **changes: Any) -> Plan:
    """Change a plan and compute the digest again, as anybody can."""
    changed = replace(plan, **changes)
    return replace(changed, certificate=replace(changed.certificate, digest=digest(changed, ARM)))


def with_certificate(plan: Plan, change: Callable[[Certificate], Certificate]) -> Plan:
    changed = replace(plan, certificate=change(plan.certificate))
    return certified(changed)


def prolonged(certificate: Certificate) -> Certificate:
    signature = certificate.signature
    assert isinstance(signature, Signature)
    return replace(certificate, signature=replace(signature, expires_ns=signature.expires_ns + 365 * DAY_NS))


def of_another_station(plan: Plan) -> Plan:
    signature = plan.certificate.signature
    assert signature is not None
    return sign_plan(plan, ARM, MotionSettings(), SigningKey(bytes(32)), issued_ns=signature.issued_ns)


FORGED_PLANS: dict[str, Callable[[Plan], Plan]] = {
    "faster": lambda plan: certified(plan, squared_rates=4.0 * plan.squared_rates),
    "other joints": lambda plan: certified(plan, joints=plan.joints + 1e-9),
    "without obstacles": lambda plan: certified(plan, scene=Scene(plan.scene.name)),
    "under another id": lambda plan: replace(plan, id="plan-000000000000"),
    "with better figures": lambda plan: with_certificate(
        plan, lambda c: replace(c, clearance=replace(c.clearance, value=1.0))
    ),
    "with a longer validity": lambda plan: with_certificate(plan, prolonged),
    "unsigned": lambda plan: with_certificate(plan, lambda c: replace(c, signature=None)),
    "of another station": of_another_station,
}


@pytest.mark.parametrize("how", list(FORGED_PLANS))
def test_a_forged_plan_sent_straight_to_the_executor_moves_nothing(
    service: Service, plans: list[Plan], how: str
) -> None:
    with attacker(service) as one:
        one.serve_certificates()
        with pytest.raises(PathRefused) as refused:
            one.start(FORGED_PLANS[how](plans[0]))
    said = str(refused.value)
    assert ("is not signed" if how == "unsigned" else "not one of this station's") in said
    assert "plan the path again at this station" in said
    wait_until(lambda: said in request(service, "GET", "/journal").text.replace('\\"', '"'), "the journal has it")


def test_a_revoked_plan_moves_nothing_by_any_way_in(service: Service, plans: list[Plan], tmp_path: Path) -> None:
    plan = plans[1]
    request(service, "POST", f"/plans/{plan.id}/revoke", {"reason": "the table was moved"})
    sentence = f"the certificate of {plan.id} was revoked: the table was moved; plan the path again"
    with attacker(service) as one:
        one.serve_certificates()
        with pytest.raises(PathRefused) as refused:
            one.start(plan)
        assert str(refused.value) == sentence
        with pytest.raises(ClientError) as over_rest:
            service.station.begin_execution(plan.id)
        assert str(over_rest.value) == sentence
        command = run("run", plan.id, "--url", service.url, folder=tmp_path)
        assert command.process.returncode != 0
        assert "was revoked: the table was moved" in " ".join((command.out + command.err).split())


def test_the_key_is_nowhere_but_in_its_file(service: Service, plans: list[Plan]) -> None:
    key = signing_key_path(service.endpoint).read_text().strip()
    secrets = (key.encode(), bytes.fromhex(key))
    for file in [*service.data.rglob("*"), *service.data.parent.glob("*.err"), *service.data.parent.glob("*.out")]:
        with suppress(FileNotFoundError, IsADirectoryError):  # a probe of the disk is there for a moment
            assert not any(secret in file.read_bytes() for secret in secrets), file
    for pid in service.find("teachpath") + service.find("forkserver"):
        for place in ("environ", "cmdline"):
            with suppress(FileNotFoundError, ProcessLookupError):  # it has ended
                assert not any(s in Path(f"/proc/{pid}/{place}").read_bytes() for s in secrets)
    for place in ("/health", f"/plans/{plans[0].id}", "/journal", "/robot"):
        assert key not in request(service, "GET", place).text


def test_an_object_that_lies_elsewhere_is_taken_there_or_not_at_all(
    service: Service, plans: list[Plan], tmp_path: Path
) -> None:
    station, plan = service.station, plans[0]
    x, y, z = station.get_object("paper").position
    lies = [x - 0.03, y + 0.04, z]
    bus = open_bus(BusSettings(endpoint=service.endpoint), find_login(service.endpoint, Role.TRACKER))
    try:
        bus.publish(KEYS.object("paper"), encode(ObjectPose(tuple(lies))))  # as a camera tells it
        wait_until(lambda: list(station.get_object("paper").position) == lies, "the station knows where it lies")
    finally:
        bus.close()
    try:
        with pytest.raises(ClientError, match=f"{plan.id} takes block at .* but it lies at"):
            station.begin_execution(plan.id)
        command = run("run", plan.path, "--adapt", "--url", service.url, folder=tmp_path)
        assert command.process.returncode == 0, command.err
        assert " ended: " in command.out
        adapted = station.plans(plan.path)[0]
        assert adapted.path_version == plan.path_version + 1
        assert list(adapted.scene.carried.position) == lies  # type: ignore[union-attr]
    finally:
        station.reset_object("paper")


def test_the_plan_that_was_signed_moves_the_arm_over_the_bus(service: Service, plans: list[Plan]) -> None:
    bus = open_bus(BusSettings(endpoint=service.endpoint), find_login(service.endpoint, Role.OPERATOR))
    try:
        one = Attacker(bus)
        one.start(plans[0])
        wait_until(lambda: len(one.setpoints) > 20, "setpoints are sent")
        one.stop()
    finally:
        bus.close()
    service.station.wait_for_arm(timeout=HANG)


def refusal(service: Service, plan: Plan) -> str:
    """What is said by both ways in, when a plan may not start."""
    with attacker(service) as one:
        with pytest.raises(TeachpathError) as refused:
            one.start(plan)
        with pytest.raises(ClientError) as over_rest:
            service.station.begin_execution(plan.id)
    assert str(over_rest.value) == str(refused.value)
    return str(refused.value)


def test_another_arm_another_calibration_and_another_time_are_refused(tmp_path: Path) -> None:
    data = tmp_path / "data"
    with Service(data) as service:
        plan = learn_and_plan(service)[0]
        assert plan.certificate.signature is not None
        assert [c.name for c in plan.certificate.signature.calibrations] == ["lab@1"]
    with Service(data, ports=service.ports, TEACHPATH_MOTION__VARIANT="fu-gonzalez-lee") as service:
        assert "holds for the corke-armstrong" in refusal(service, plan)
    with Service(data, ports=service.ports, TEACHPATH_MOTION__CLEARANCE_MIN="0.01") as service:
        assert "motion.clearance_min = 0.005, and it is 0.01 now" in refusal(service, plan)
    with Service(data, ports=service.ports, TEACHPATH_MOTION__CERTIFICATE_VALIDITY="1e-6") as service:
        brief = stored(service, service.station.plan(plan.path).id)
        assert brief.certificate.signature is not None
        end = brief.certificate.signature.expires_ns
        wait_until(lambda: time.time_ns() > end, "its time is over")
        assert "expired" in refusal(service, brief)
        measure(service, 0.01)
        assert "calibration lab@1 has been measured anew (lab@2)" in refusal(service, plan)
    with Service(tmp_path / "other" / "data") as other:
        foreign = refusal_of_a_stranger(other, plan)
    assert "another station" in foreign


def refusal_of_a_stranger(service: Service, plan: Plan) -> str:
    with attacker(service) as one, pytest.raises(PathRefused) as refused:
        one.start(plan)
    return str(refused.value)
