"""The control lease: at most one holder of control at a time, whom everybody sees.

While nobody holds it, everybody may command. The holder sends beats, and the lease lapses when they stop. Somebody else
may request control: the holder releases or keeps it, and a holder who does not answer in time loses it.
"""

from __future__ import annotations

import secrets
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from teachpath.errors import Conflict
from teachpath.records import Lease, LeaseRequest
from teachpath_proto.control import LeaseAction

DEFAULT_BEAT_INTERVAL: Final = 5.0  # [s] between two beats at most, unless the holder chooses another
GRANT_DELAY: Final = 10.0  # [s] that the holder has to answer a request


@dataclass
class _Claimant:
    """Somebody who holds control, or requests it."""

    name: str
    token: str
    seconds: float
    hold_when_lost: bool
    expires: float  # [s of the clock], without another beat


class ControlLease:
    """Grants control; safe to use from several threads.

    Args:
        clock: returns monotonic nanoseconds.
        token: returns a new secret.
    """

    def __init__(self, clock: Callable[[], int], token: Callable[[], str] = lambda: secrets.token_hex(8)) -> None:
        self._clock, self._token = clock, token
        self._lock = threading.Lock()
        self._holder: _Claimant | None = None
        self._requester: _Claimant | None = None
        self._grant_time = 0.0  # [s of the clock], when the requester gets control
        self._lost = ""

    def answer(self, request: LeaseRequest) -> Lease:
        """Act on a request and return who is in control afterwards.

        Raises:
            Conflict: somebody else is in control or requests it already, or the token is out of date.
        """
        with self._lock:
            now = self._update()
            if request.action == LeaseAction.ACQUIRE:
                return self._view(now, self._acquire(request, now))
            if request.action == LeaseAction.ASK:
                return self._view(now, self._ask(request, now))
            if request.action == LeaseAction.LOOK:
                return self._view(now, None)
            claimant = self._claimant_of(request.token)
            if request.action == LeaseAction.BEAT:
                claimant.expires = now + claimant.seconds
            elif request.action == LeaseAction.KEEP and claimant is self._holder:
                self._requester = None
            elif request.action == LeaseAction.RELEASE and claimant is self._holder:
                self._holder = None
                self._update()
            elif request.action == LeaseAction.RELEASE:
                self._requester = None
            return self._view(now, claimant)

    def require(self, token: str, who: str) -> str:
        """Return the name under which a command may be given.

        Args:
            token: of the lease, or empty.
            who: name for the journal of somebody without a lease.

        Raises:
            Conflict: somebody else is in control, or the token is out of date.
        """
        with self._lock:
            now = self._update()
            if token:
                claimant = self._claimant_of(token)
                if claimant is self._holder:
                    return claimant.name
            if self._holder is not None:
                raise Conflict(self._describe_holder(now))
            return who

    def name_of(self, token: str, who: str) -> str:
        """Return the name that belongs to a token, or `who`; never refuses."""
        with self._lock:
            self._update()
            known = [h for h in (self._holder, self._requester) if h is not None and token and h.token == token]
            return known[0].name if known else who

    def public_view(self) -> Lease:
        """Return who is in control, without any token."""
        with self._lock:
            return self._view(self._update(), None)

    def pop_lost_holder(self) -> str:
        """Return once the name of a holder whose beats stopped and who wanted the arm held then; otherwise nothing."""
        with self._lock:
            self._update()
            lost, self._lost = self._lost, ""
            return lost

    def _update(self) -> float:
        """End claims without beats, grant a request that is due, and return the present time [s of the clock]."""
        now = self._clock() / 1e9
        holder, requester = self._holder, self._requester
        if requester is not None and now > requester.expires:
            self._requester = requester = None
        if holder is not None and now > holder.expires:
            self._lost = holder.name if holder.hold_when_lost else ""
            self._holder = holder = None
        if requester is not None and (holder is None or now >= self._grant_time):
            requester.expires = now + requester.seconds
            self._holder, self._requester = requester, None
        return now

    def _acquire(self, request: LeaseRequest, now: float) -> _Claimant:
        if self._holder is not None:
            raise Conflict(self._describe_holder(now))
        self._holder = self._new(request, now)
        return self._holder

    def _ask(self, request: LeaseRequest, now: float) -> _Claimant:
        if self._holder is None:
            return self._acquire(request, now)
        if self._requester is not None:
            raise Conflict(f"{self._requester.name} asks for control already; ask again when that is decided")
        self._requester, self._grant_time = self._new(request, now), now + GRANT_DELAY
        return self._requester

    def _new(self, request: LeaseRequest, now: float) -> _Claimant:
        seconds = request.seconds or DEFAULT_BEAT_INTERVAL
        return _Claimant(request.name.strip(), self._token(), seconds, request.hold_when_lost, now + seconds)

    def _claimant_of(self, token: str) -> _Claimant:
        for claimant in (self._holder, self._requester):
            if claimant is not None and token == claimant.token:
                return claimant
        holder = f"{self._holder.name} is in control" if self._holder else "nobody is in control"
        raise Conflict(f"this hold on control is over: it lapsed, was handed over or kept ({holder}); acquire it again")

    def _describe_holder(self, now: float) -> str:
        assert self._holder is not None
        return (
            f"{self._holder.name} is in control; ask for it (POST /api/v1/lease/ask, or in the page), or wait: it "
            f"lapses {self._holder.expires - now:.0f} s after its last beat. Stop is open to everybody"
        )

    def _view(self, now: float, claimant: _Claimant | None) -> Lease:
        holder, requester = self._holder, self._requester
        return Lease(
            holder=holder.name if holder else "",
            expires_in=holder.expires - now if holder else 0.0,
            hold_when_lost=holder.hold_when_lost if holder else False,
            asking=requester.name if requester else "",
            granted_in=max(self._grant_time - now, 0.0) if requester else 0.0,
            token=claimant.token if claimant is not None and claimant in (holder, requester) else "",
        )
