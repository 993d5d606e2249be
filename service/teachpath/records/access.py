"""Who may do what at a station: capabilities, and the tokens of programs."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Final


class Capability(StrEnum):
    """What somebody may do over REST and WebSockets."""

    VIEW = "view"  # look at everything
    DEMONSTRATE = "demonstrate"  # record, import, mark and discard demonstrations
    TEACH = "teach"  # learn, edit and plan paths, measure calibrations, say where objects lie
    OPERATE = "operate"  # take control of the arm, move it, lead it by hand
    ADMINISTER = "administer"  # make and revoke tokens


# What a role may do: it is named after the capability that it is for, and has those without which that is no use.
ROLES: Final[dict[Capability, frozenset[Capability]]] = {
    Capability.VIEW: frozenset({Capability.VIEW}),
    Capability.DEMONSTRATE: frozenset({Capability.VIEW, Capability.DEMONSTRATE}),
    Capability.TEACH: frozenset({Capability.VIEW, Capability.DEMONSTRATE, Capability.TEACH}),
    Capability.OPERATE: frozenset({Capability.VIEW, Capability.DEMONSTRATE, Capability.OPERATE}),
    Capability.ADMINISTER: frozenset(Capability),
}


@dataclass(frozen=True, slots=True)
class AccessToken:
    """A token by which a program says who it is; of the token itself only the hash is kept.

    Attributes:
        name: of the program, in the journal and wherever it leaves its name.
        roles: that it has.
        digest: SHA-256 of the token (hex).
        expires_ns: from when on it holds no longer.
        used_ns: when it was last used, to the minute; 0: never.
        revoked_ns: when it was revoked; 0: it was not.
    """

    name: str
    roles: tuple[Capability, ...]
    digest: str = field(repr=False)
    created_ns: int
    expires_ns: int
    used_ns: int = 0
    revoked_ns: int = 0

    @property
    def capabilities(self) -> frozenset[Capability]:
        """What its roles may do together."""
        return capabilities_of(self.roles)

    def holds(self, now_ns: int) -> bool:
        """Tell whether it is neither revoked nor expired."""
        return not self.revoked_ns and now_ns < self.expires_ns


@dataclass(frozen=True, slots=True)
class Person:
    """Somebody who signs in with a password, or at a provider of OpenID Connect.

    Attributes:
        password_hash: of Argon2; empty: signs in at a provider.
        changed_ns: when the password was set; sessions of before have ended.
        issuer: address of the provider; empty: signs in with a password.
        subject: who it is at the provider, whatever name it has there.
    """

    name: str
    roles: tuple[Capability, ...]
    password_hash: str = field(repr=False)
    created_ns: int
    changed_ns: int
    issuer: str = ""
    subject: str = ""


@dataclass(frozen=True, slots=True)
class Session:
    """A person who has signed in at a browser.

    Attributes:
        digest: SHA-256 of its secret (hex).
        used_ns: when something was asked in it last.
    """

    digest: str = field(repr=False)
    person: str
    created_ns: int
    used_ns: int


@dataclass(frozen=True, slots=True)
class CodeGrant:
    """A code of a provider of OpenID Connect, and what the station had asked with.

    Attributes:
        code: for one ID token.
        redirect_uri: to which the code was sent.
        verifier: of PKCE (RFC 7636).
        nonce: that the ID token has to hold.
    """

    code: str = field(repr=False)
    redirect_uri: str
    verifier: str = field(repr=False)
    nonce: str = field(repr=False)


@dataclass(frozen=True, slots=True)
class Subject:
    """Who sends a request.

    Attributes:
        name: authenticated; empty where the station does not ask who somebody is.
        capabilities: what it may do.
        credential: digest of what it has shown; empty: nothing.
        groups: of whom a proxy brings, as it tells them.
    """

    name: str
    capabilities: frozenset[Capability]
    credential: str = ""
    groups: tuple[str, ...] = ()


def capabilities_of(roles: Iterable[Capability]) -> frozenset[Capability]:
    """Return what roles may do together."""
    return frozenset().union(*(ROLES[role] for role in roles))
