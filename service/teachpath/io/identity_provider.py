"""The way to a provider of OpenID Connect: its discovery, its keys, and the ID tokens that it gives for codes."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from ssl import SSLContext, SSLError, create_default_context
from typing import Any, Final
from urllib.parse import quote_plus, urlsplit

import httpx
from joserfc import jwt
from joserfc.errors import InvalidKeyIdError, JoseError
from joserfc.jwk import KeySet

from teachpath.errors import NotSignedIn, Unreachable, UnusableSettings
from teachpath.io.private_files import refuse_shared
from teachpath.records import CodeGrant

TIMEOUT: Final = 5.0  # [s] for each step of an answer of the provider
KEY_SET_LIFETIME: Final = 3600.0  # [s] for which discovery and keys are kept
LEEWAY: Final = 60  # [s] by which the clocks of provider and station may differ
MAX_SECRET: Final = 4096  # bytes of the file of the client's secret
# Signatures by the provider's private key alone: with `none`, or a secret that both have, others could sign.
ALGORITHMS: Final = (
    "RS256",
    "RS384",
    "RS512",
    "PS256",
    "PS384",
    "PS512",
    "ES256",
    "ES384",
    "ES512",
    "Ed25519",
    "EdDSA",
)
THIS_MACHINE: Final = ("localhost", "127.0.0.1", "::1")
ERROR_CODE: Final = re.compile(r"[a-z_]{1,40}")  # of OAuth


@dataclass(frozen=True, slots=True)
class ProviderClient:
    """A station as the client of a provider.

    Attributes:
        name: of the provider, in sentences.
        issuer: address of the provider.
        client_id: of the station there.
        secret_file: with the client's secret; empty: it has none.
        authorities: file of those that vouch for the provider's https (PEM); empty: the public ones.
    """

    name: str
    issuer: str
    client_id: str
    secret_file: str = ""
    authorities: str = ""


class IdentityProvider:
    """A provider of OpenID Connect, as a client of it sees it; safe to use from several threads.

    Args:
        client: the station there.
        now: the time [s since the Unix epoch].

    Raises:
        UnusableSettings: the address is not safe, or the secret or the authorities cannot be read.
    """

    def __init__(self, client: ProviderClient, now: Callable[[], float] = time.time) -> None:
        _require_safe("setting oidc.issuer", client.issuer)
        self._client, self._now = client, now
        self._secret = _read_secret(client.secret_file)
        self._verify = _authorities(client.authorities)
        self._metadata: tuple[float, dict[str, Any]] = (-KEY_SET_LIFETIME, {})
        self._keys: tuple[float, KeySet | None] = (-KEY_SET_LIFETIME, None)
        self._lock = threading.Lock()

    def metadata(self) -> Mapping[str, Any]:
        """Return what the provider says of itself (OpenID Connect Discovery); raises Unreachable."""
        with self._lock:
            read, known = self._metadata
        if known and self._now() - read < KEY_SET_LIFETIME:
            return known
        found = self._get(self._client.issuer.rstrip("/") + "/.well-known/openid-configuration")
        if found.get("issuer") != self._client.issuer:
            raise self._unreachable(f"says that it is {found.get('issuer')!r}, and oidc.issuer is another")
        for name in ("authorization_endpoint", "token_endpoint", "jwks_uri"):
            try:
                _require_safe(name, str(found.get(name)))
            except UnusableSettings as error:
                raise self._unreachable(f"says what cannot be used: {error}") from None
        with self._lock:
            self._metadata = self._now(), found
        return found

    def claims(self, grant: CodeGrant) -> Mapping[str, Any]:
        """Return what the ID token for a code says, after all that OpenID Connect Core, 3.1.3.7, asks for.

        Raises:
            NotSignedIn: the provider does not take the code, or its token is none for this sign-in.
            Unreachable: the provider does not answer, or does not know this station.
        """
        token = self._exchange(grant)
        try:
            claims = self._verified(token)
            self._registry(grant.nonce).validate(claims)
        except (JoseError, ValueError, TypeError) as error:
            raise NotSignedIn(
                f"the ID token of {self._client.name} cannot be believed ({_reason(error)}); sign in again"
            ) from None
        others = isinstance(claims["aud"], list) and len(claims["aud"]) > 1
        if claims.get("azp", "" if others else self._client.client_id) != self._client.client_id:
            raise NotSignedIn(f"the ID token of {self._client.name} was made for another program; sign in again")
        return claims

    def _registry(self, nonce: str) -> jwt.JWTClaimsRegistry:
        return jwt.JWTClaimsRegistry(
            now=lambda: int(self._now()),
            leeway=LEEWAY,
            iss={"essential": True, "value": self._client.issuer},
            aud={"essential": True, "value": self._client.client_id},
            nonce={"essential": True, "value": nonce},
            sub={"essential": True},
            exp={"essential": True},
            iat={"essential": True},
        )

    def _verified(self, token: str) -> dict[str, Any]:
        """Return the claims of a token that the provider has signed; a key that is not known is looked for once."""
        with self._lock:
            read, keys = self._keys
        if keys is not None and self._now() - read < KEY_SET_LIFETIME:
            try:
                return jwt.decode(token, keys, ALGORITHMS).claims
            except InvalidKeyIdError:
                pass  # the provider has taken another key since
        keys = self._read_keys()
        with self._lock:
            self._keys = self._now(), keys
        return jwt.decode(token, keys, ALGORITHMS).claims

    def _read_keys(self) -> KeySet:
        document: Any = self._get(self.metadata()["jwks_uri"])
        try:
            return KeySet.import_key_set(document)
        except (JoseError, ValueError, TypeError, KeyError, AttributeError):
            raise self._unreachable("gives keys that cannot be read") from None

    def _exchange(self, grant: CodeGrant) -> str:
        form = {
            "grant_type": "authorization_code",
            "code": grant.code,
            "redirect_uri": grant.redirect_uri,
            "code_verifier": grant.verifier,
        }
        metadata, name = self.metadata(), self._client.client_id
        login = None
        if not self._secret:
            form["client_id"] = name
        elif "client_secret_basic" in metadata.get("token_endpoint_auth_methods_supported", ["client_secret_basic"]):
            login = httpx.BasicAuth(quote_plus(name), quote_plus(self._secret))
        else:
            form |= {"client_id": name, "client_secret": self._secret}
        answer = self._send("POST", metadata["token_endpoint"], data=form, auth=login)
        document = _document(answer)
        token = document.get("id_token")
        if answer.status_code == 200 and isinstance(token, str):
            return token
        code = str(document.get("error", ""))
        code = code if ERROR_CODE.fullmatch(code) else f"status {answer.status_code}"
        if code == "invalid_grant":
            raise NotSignedIn(f"{self._client.name} does not take this sign-in any more ({code}); sign in again")
        raise self._unreachable(
            f"gives this station no ID token ({code}); check oidc.client_id and oidc.client_secret_file"
        )

    def _get(self, address: str) -> dict[str, Any]:
        answer = self._send("GET", address)
        document = _document(answer)
        if answer.status_code != 200 or not document:
            raise self._unreachable(f"answers {answer.status_code} at {address}, and not what it should")
        return document

    def _send(self, method: str, address: str, **options: Any) -> httpx.Response:
        try:
            with httpx.Client(verify=self._verify, timeout=TIMEOUT) as client:
                return client.request(method, address, **options)
        except (httpx.HTTPError, httpx.InvalidURL) as error:
            fault = str(error) or type(error).__name__
            raise self._unreachable(f"does not answer at {urlsplit(address).netloc}: {fault}") from None

    def _unreachable(self, fault: str) -> Unreachable:
        return Unreachable(f"{self._client.name} {fault}; nobody can sign in until it does; programs may with a token")


def _require_safe(what: str, address: str) -> None:
    """Raise UnusableSettings where others could read or change what is sent to an address."""
    try:
        parts = urlsplit(address)
        is_safe = parts.scheme == "https" or (parts.scheme == "http" and parts.hostname in THIS_MACHINE)
    except ValueError:
        is_safe = False
    if not is_safe or not parts.hostname or parts.query or parts.fragment:
        raise UnusableSettings(f"{what} is {address!r}; it should be https://HOST/..., or http of this machine")


def _document(answer: httpx.Response) -> dict[str, Any]:
    try:
        document = answer.json()
    except ValueError:
        return {}
    return document if isinstance(document, dict) else {}


def _reason(error: Exception) -> str:
    return str(error) if isinstance(error, JoseError) else "it cannot be read"


def _read_secret(file: str) -> str:
    if not file:
        return ""
    try:
        with Path(file).open() as opened:
            refuse_shared(
                f"the secret {file}", Path(file).stat(), f"chmod 600 {file}, and let the provider give another"
            )
            secret = opened.read(MAX_SECRET).strip()
    except (OSError, ValueError) as error:
        raise UnusableSettings(f"setting oidc.client_secret_file: cannot read {file!r} ({error})") from None
    if not secret:
        raise UnusableSettings(f"setting oidc.client_secret_file: {file!r} is empty")
    return secret


def _authorities(file: str) -> SSLContext:
    if not file:
        return httpx.create_ssl_context()
    try:
        return create_default_context(cafile=file)
    except (OSError, SSLError) as error:
        raise UnusableSettings(f"setting oidc.authorities: {file!r} has no certificates in PEM ({error})") from None
