"""Settings of who may do what."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le


@dataclass(frozen=True)
class AuthSettings:
    """How the station tells who asks."""

    # none: asks nobody, answers this machine alone; token: programs show tokens, people sign in with passwords; oidc:
    # programs show tokens, people sign in at a provider ([oidc]); proxy: web.proxies ask, and tell the groups ([proxy])
    mode: Literal["none", "token", "oidc", "proxy"] = "none"
    # [s] after which a session ends in which nothing was asked
    session_idle: Annotated[float, Ge(60), Le(604_800)] = 3600.0
    # [s] after which a session ends, whatever is asked
    session_length: Annotated[float, Ge(60), Le(2_592_000)] = 43_200.0


@dataclass(frozen=True)
class OidcSettings:
    """The provider of OpenID Connect at which people sign in, where auth.mode is oidc."""

    # of the provider; the page says: Sign in with NAME
    name: str = "OpenID Connect"
    # address of the provider, as its discovery document says it; https, or http of this machine
    issuer: str = ""
    # of this station at the provider, where the address of its page is a redirect URI
    client_id: str = ""
    # file of the client's secret, mode 0600; empty: the client has none (public, with PKCE)
    client_secret_file: str = ""
    # file of the authorities that vouch for the provider's https (PEM); empty: the public ones
    authorities: str = ""
    # what is asked for beside openid
    scopes: tuple[str, ...] = ("profile",)
    # what the provider asks at each sign-in; empty: nothing, if whoever used the device before is still known there
    prompt: Literal["login", "select_account", ""] = "login"
    # claim of the ID token that is a person's name here; of an e-mail address what stands before the @
    name_claim: str = "preferred_username"
    # claim of the ID token that has the groups of a person
    groups_claim: str = "groups"
    # groups whose people have the role view; who is in no group that is named has none, and is refused
    view: tuple[str, ...] = ()
    # groups whose people have the role demonstrate
    demonstrate: tuple[str, ...] = ()
    # groups whose people have the role teach
    teach: tuple[str, ...] = ()
    # groups whose people have the role operate
    operate: tuple[str, ...] = ()
    # groups whose people have the role administer
    administer: tuple[str, ...] = ()


@dataclass(frozen=True)
class ProxySettings:
    """What those may do whom a proxy brings, where auth.mode is proxy."""

    # header in which the proxy tells the groups of a person, with commas between them; it sets or removes it always
    groups_header: str = "X-Forwarded-Groups"
    # groups whose people have the role view, * for whoever comes through; who is in no group that is named has none
    view: tuple[str, ...] = ()
    # groups whose people have the role demonstrate
    demonstrate: tuple[str, ...] = ()
    # groups whose people have the role teach
    teach: tuple[str, ...] = ()
    # groups whose people have the role operate
    operate: tuple[str, ...] = ()
    # groups whose people have the role administer
    administer: tuple[str, ...] = ()


@dataclass(frozen=True)
class LimitSettings:
    """What one token, person or address may ask for at a time, but for stops; they hold where auth.mode is not none."""

    # [1/s] requests and new WebSockets, after a burst
    request_rate: Annotated[float, Gt(0), Le(1_000_000)] = 200.0
    # requests that may come at once before that rate counts
    request_burst: Annotated[int, Ge(1), Le(1_000_000)] = 3000
    # requests that may be under way at a time
    max_requests: Annotated[int, Ge(1), Le(100_000)] = 100
    # files that may be sent at a time
    max_uploads: Annotated[int, Ge(1), Le(100_000)] = 10
    # WebSockets that may be open at a time; a tab of the page has three, and one for its hand
    max_websockets: Annotated[int, Ge(1), Le(100_000)] = 400
    # bytes of the files that wait to be imported, whatever auth.mode is
    waiting_size: Annotated[int, Ge(1024)] = 8_589_934_592
