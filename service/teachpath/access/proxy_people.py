"""Whom a proxy brings that has asked who somebody is: which of the groups that it tells have which role."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from typing import Any, Final

from teachpath.access.settings import OidcSettings, ProxySettings
from teachpath.errors import NotSignedIn, UnusableSettings
from teachpath.records import Capability, Subject, capabilities_of

FORWARDED_USER: Final = "X-Forwarded-User"  # header of who somebody is
ALL_GROUPS: Final = "*"  # in the settings: whoever comes through the proxy
HEADER: Final = re.compile(r"[a-z0-9-]{1,64}", re.ASCII | re.IGNORECASE)
MAX_NAME_LENGTH: Final = 64  # characters of a name that a proxy gives
MAX_SHOWN: Final = 8  # groups of somebody that a sentence names
MAX_GROUP_LENGTH: Final = 60  # characters of each of them


@dataclass(frozen=True, slots=True)
class Forwarded:
    """What a proxy says of whom it asks for.

    Attributes:
        user: name; empty: it says none.
        groups: of the user, with commas between them.
    """

    user: str = ""
    groups: str = ""


NOT_FORWARDED: Final = Forwarded()


class ProxyPeople:
    """Tells what those may do whom a proxy brings.

    Args:
        settings: which groups have which role.
    """

    def __init__(self, settings: ProxySettings) -> None:
        self.header: str = settings.groups_header
        self._settings = settings

    def subject(self, forwarded: Forwarded) -> Subject:
        """Return whom a proxy brings, with the roles of the groups.

        Raises:
            NotSignedIn: groups without a name, under which nobody could be found in the journal.
        """
        name = "".join(filter(str.isprintable, _decoded(forwarded.user)))[:MAX_NAME_LENGTH]
        told = (each.strip() for each in _decoded(forwarded.groups).split(","))
        groups = tuple(group for group in told if group and group.isprintable())
        if groups and not name:
            raise NotSignedIn(
                f"the proxy tells groups ({self.header}) and no name; let it set {FORWARDED_USER} beside them"
            )
        roles = roles_of(self._settings, (*groups, ALL_GROUPS))
        return Subject(name, capabilities_of(roles), groups=groups)

    def way_out(self, subject: Subject, needed: Capability) -> str:
        """Say how a subject gets a role that it lacks."""
        if not subject.name:
            return f"the proxy names nobody ({FORWARDED_USER}): sign in there"
        return (
            f"the proxy tells its groups ({self.header}): {listed(subject.groups)}; whoever administers the station "
            f"gives one of them a role with proxy.{needed.value}"
        )


def require_roles(mode: str, settings: ProxySettings) -> None:
    """Check that the settings tell what those may do whom a proxy brings.

    Args:
        mode: of authentication.
        settings: which groups have which role.

    Raises:
        UnusableSettings: no group has a role, a group can be none, or no header has that name.
    """
    if mode != "proxy":
        return
    named = {role: getattr(settings, role.value) for role in Capability}
    if not any(named.values()):
        raise UnusableSettings(
            "auth.mode is proxy, and no group has a role, so that nobody could do more than stop the arm: name groups "
            'that the proxy tells with proxy.view, proxy.operate, ..., e.g. proxy.operate = ["cell-3-operators"]; '
            'where whoever passes may do everything: proxy.administer = ["*"] (docs/access.md)'
        )
    for role, groups in named.items():
        for group in groups:
            if "," in group or group != group.strip() or not group:
                raise UnusableSettings(
                    f"setting proxy.{role.value} holds {group!r}, and the groups of {settings.groups_header} stand "
                    "between commas: no group there has one in its name, is empty or begins or ends with a space"
                )
    if not HEADER.fullmatch(settings.groups_header):
        raise UnusableSettings(
            f"setting proxy.groups_header is {settings.groups_header!r}; a header's name has letters, digits and -"
        )


def roles_of(settings: OidcSettings | ProxySettings, groups: Collection[Any]) -> tuple[Capability, ...]:
    """Return the roles that the settings give to somebody in some groups."""
    return tuple(role for role in Capability if any(group in groups for group in getattr(settings, role.value)))


def listed(groups: Collection[Any]) -> str:
    """Return groups as a sentence names them; of many the first."""
    return ", ".join(str(group)[:MAX_GROUP_LENGTH] for group in list(groups)[:MAX_SHOWN]) or "none"


def _decoded(header: str) -> str:
    """Return a header's text: read as Latin-1 where it was UTF-8, it is read again."""
    try:
        return header.encode("latin-1").decode()
    except UnicodeError:
        return header
