"""Answers the executor whether the certificate of a stored plan still holds: revocation, scene and calibrations."""

from __future__ import annotations

import hmac
from collections.abc import Callable
from dataclasses import replace

from teachpath.errors import NotFound, PathRefused
from teachpath.io import documents
from teachpath.io.bus import Bus, Handle
from teachpath.io.store.store import Store
from teachpath.records import Calibration, CertificateQuery, Plan, Scene, Shape, Signature
from teachpath_proto.keys import Keys


class CertificateStatus:
    """Serves the question of the executor.

    Args:
        scene: returns the present scene of a name; raises NotFound.
        calibration: returns the newest version of a calibration.
    """

    def __init__(
        self,
        bus: Bus,
        keys: Keys,
        store: Store,
        *,
        scene: Callable[[str], Scene],
        calibration: Callable[[Calibration], Calibration],
    ) -> None:
        self._bus = bus
        self._keys = keys
        self._store = store
        self._scene = scene
        self._calibration = calibration
        self._handle: Handle | None = None

    def start(self) -> None:
        """Answer from now on."""
        self._handle = self._bus.serve(self._keys.station_certificate, self._answer)

    def stop(self) -> None:
        """Answer no longer."""
        if self._handle is not None:
            self._handle.close()
            self._handle = None

    def check(self, query: CertificateQuery) -> None:
        """Check that the certificate of a stored plan holds.

        Raises:
            PathRefused: the plan is not stored here as it was signed, its certificate was revoked, or its scene or
                calibration has changed since.
        """
        try:
            plan = self._store.plan(query.plan)
        except NotFound:
            raise PathRefused(f"this station has stored no plan {query.plan!r}; plan the path again here") from None
        signature = plan.certificate.signature
        if signature is None or not hmac.compare_digest(signature.mac.encode(), query.mac.encode()):
            raise PathRefused(
                f"plan {plan.id} is stored with another signature than the one to start; start the stored one, or plan "
                "the path again"
            )
        if reason := self._store.journal.revoked(plan.id):
            raise PathRefused(f"the certificate of {plan.id} was revoked: {reason}; plan the path again")
        self._check_scene(plan)
        self._check_calibrations(plan.id, signature)

    def _answer(self, payload: bytes) -> bytes:
        query = documents.decode(CertificateQuery, payload)
        self.check(query)
        return documents.encode(query)

    def _check_scene(self, plan: Plan) -> None:
        name = plan.scene.name
        try:
            present = self._scene(name)
        except NotFound as error:
            raise PathRefused(
                f"{plan.id} was certified in scene {name}: {error}; make that scene again, or plan the path "
                "again in another one"
            ) from None
        taken, lies = plan.scene.carried, present.carried
        if taken and lies and present != plan.scene and replace(present, carried=taken) == plan.scene:
            raise PathRefused(
                f"plan {plan.id} takes {taken.name} at {_place(taken)}, but it lies at {_place(lies)}; put it there "
                f"and say so (teachpath object {name} --at x,y,z), or adapt the path to where it lies (teachpath run "
                "PATH --adapt)"
            )
        if present != plan.scene:
            raise PathRefused(f"scene {name} has changed since {plan.id} was certified; plan the path again")

    def _check_calibrations(self, plan: str, signature: Signature) -> None:
        for recorded, then in zip(signature.calibrations, signature.present_calibrations, strict=True):
            now = self._calibration(recorded)
            if replace(now, name=then.name) != then:  # the same mapping, measured again, is no other
                change = "has been set otherwise" if now.name == then.name else f"has been measured anew ({now.name})"
                raise PathRefused(
                    f"calibration {then.name} {change} since {plan} was certified for it; if it was wrong then, "
                    "recalibrate the task and learn anew (teachpath recalibrate), else plan the path again"
                )


def _place(shape: Shape) -> str:
    return ", ".join(f"{value:.3f}" for value in shape.position)
