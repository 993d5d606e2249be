"""The one door to motion along a plan: signature and scope are checked here, the rest is asked of the service."""

from __future__ import annotations

from typing import Final

from teachpath.errors import PathRefused, Unreachable
from teachpath.io import documents
from teachpath.io.bus import Bus
from teachpath.motion.arm.model import Arm
from teachpath.motion.planning.signature import SigningKey, check_validity, verify_signature
from teachpath.motion.settings import MotionSettings
from teachpath.records import CertificateQuery, Plan
from teachpath.time_source import TimeSource
from teachpath_proto.keys import Keys

ANSWER_TIMEOUT: Final = 5.0  # [s] that the service may take to answer; without an answer nothing moves


class CertificateCheck:
    """Refuses plans that may not move the arm.

    Args:
        key: of the station.
        motion: settings for which certificates have to hold.
        arm: that is moved.
    """

    def __init__(
        self, bus: Bus, keys: Keys, key: SigningKey, motion: MotionSettings, arm: Arm, time_source: TimeSource
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._key = key
        self._motion = motion
        self._arm = arm
        self._time = time_source

    def verify(self, plan: Plan) -> None:
        """Check that a plan may start.

        Raises:
            PathRefused: the station did not sign it, it is for another arm or other settings, its certificate has
                expired or was revoked, its scene or calibration has changed, or the service does not answer.
        """
        verify_signature(plan, self._arm, self._motion, self._key, self._time.wall_ns())
        self._ask_service(plan)

    def confirm(self, plan: Plan) -> None:
        """Check that the certificate of a plan that was verified when it started still holds; raises PathRefused."""
        check_validity(plan, self._time.wall_ns())
        self._ask_service(plan)

    def _ask_service(self, plan: Plan) -> None:
        assert plan.certificate.signature is not None
        query = CertificateQuery(plan.id, plan.certificate.signature.mac)
        try:
            answer = self._bus.ask(self._keys.station_certificate, documents.encode(query), timeout=ANSWER_TIMEOUT)
        except Unreachable:
            raise PathRefused(
                f"the service did not answer whether the certificate of plan {plan.id} still holds (it may be revoked, "
                "or its scene changed), and the arm does not move without that; start the service (teachpath serve), "
                "then start the plan again"
            ) from None
        if answer != documents.encode(query):
            raise PathRefused(f"the service answered for another plan than {plan.id}; start the plan again")
