"""A provider of OpenID Connect on a real port of this machine; it can be told to do each thing wrong."""

import base64
import hashlib
import json
import secrets
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, parse_qsl, unquote_plus, urlencode, urlsplit

from joserfc import jwt
from joserfc.jwk import ECKey, KeySet

CLIENT, SECRET = "cell-3", "a client's secret: with signs & spaces"
PERSON = {"sub": "248289761001", "preferred_username": "anna", "groups": ["lab", "teachers"]}


def new_key(name: str) -> ECKey:
    return ECKey.generate_key("P-256", {"kid": name, "use": "sig", "alg": "ES256"})


class EmulatedProvider:
    """What it says and does is right until a test changes it.

    Attributes:
        person: who signs in, as claims.
        claims: what else the ID token says, or says otherwise; None: leaves out.
        now: its time [s since the Unix epoch].
        sign: makes the token of claims.
        metadata: what discovery says otherwise.
        answer: what the address to which it sends a browser back says otherwise.
        asked: the last request for a code.
    """

    def __init__(self, address: str, now: Callable[[], float]) -> None:
        self.issuer, self.now = address, now
        self.asked: dict[str, str] = {}
        self._codes: dict[str, dict[str, str]] = {}
        self._first = new_key("first")
        self.reset()

    def reset(self) -> None:
        """Be right again."""
        self.keys = [self._first]
        self.person: dict[str, Any] = dict(PERSON)
        self.claims: dict[str, Any] = {}
        self.metadata: dict[str, Any] = {}
        self.answer: dict[str, str] = {}
        self.sign: Callable[[dict[str, Any]], str] = self.signed

    def signed(self, claims: dict[str, Any]) -> str:
        """Sign with the newest key."""
        return jwt.encode({"alg": "ES256", "kid": self.keys[-1].kid}, claims, self.keys[-1])

    def get(self, path: str, asked: dict[str, str]) -> tuple[int, dict[str, Any] | str]:
        """Answer a reader: a document, or where to go."""
        if path == "/.well-known/openid-configuration":
            ends = {"authorization_endpoint": "authorize", "token_endpoint": "token", "jwks_uri": "keys"}
            document = {name: f"{self.issuer}/{end}" for name, end in ends.items()}
            return 200, {"issuer": self.issuer} | document | self.metadata
        if path == "/keys":
            return 200, dict(KeySet(list(self.keys)).as_dict(private=False))
        if path != "/authorize" or asked["client_id"] != CLIENT or asked["response_type"] != "code":
            return 400, {"error": "invalid_request"}
        self.asked, code = asked, secrets.token_urlsafe()
        self._codes[code] = asked
        given = {"code": code, "state": asked["state"]} | self.answer
        return 302, f"{asked['redirect_uri']}?{urlencode(given)}"

    def token(self, form: dict[str, str], authorization: str) -> tuple[int, dict[str, Any]]:
        """Give an ID token for a code, once, to who has asked for it."""
        shown = base64.b64decode(authorization.removeprefix("Basic ")).decode().partition(":")[::2]
        basic = tuple(map(unquote_plus, shown))
        posted = form.get("client_id"), form.get("client_secret")
        by_post = self.metadata.get("token_endpoint_auth_methods_supported", [""])[0] == "client_secret_post"
        if (posted if by_post else basic) != (CLIENT, SECRET):
            return 401, {"error": "invalid_client"}
        asked = self._codes.pop(form.get("code", ""), None)
        proof = base64.urlsafe_b64encode(hashlib.sha256(form.get("code_verifier", "").encode()).digest())
        if (
            asked is None
            or asked["code_challenge"] != proof.rstrip(b"=").decode()
            or asked["code_challenge_method"] != "S256"
            or asked["redirect_uri"] != form["redirect_uri"]
        ):
            return 400, {"error": "invalid_grant"}
        now = int(self.now())
        times = {"iat": now, "exp": now + 300}
        claims = {"iss": self.issuer, "aud": CLIENT, "nonce": asked["nonce"]} | times | self.person | self.claims
        told = {name: value for name, value in claims.items() if value is not None}
        return 200, {"access_token": "x", "token_type": "Bearer", "id_token": self.sign(told)}


@contextmanager
def running(now: Callable[[], float] = time.time) -> Iterator[EmulatedProvider]:
    """Run a provider whose time is `now` [s since the Unix epoch]."""

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_GET(self) -> None:
            parts = urlsplit(self.path)
            status, found = provider.get(parts.path, dict(parse_qsl(parts.query)))
            if isinstance(found, str):
                self.send_response(status)
                self.send_header("Location", found)
                self.send_header("Content-Length", "0")
                self.end_headers()
            else:
                self._send(status, found)

        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"])).decode()
            form = {name: values[0] for name, values in parse_qs(body).items()}
            self._send(*provider.token(form, self.headers.get("Authorization", "")))

        def _send(self, status: int, document: dict[str, Any]) -> None:
            content = json.dumps(document).encode()
            self.send_response(status)
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(content)))
            self.end_headers()
            self.wfile.write(content)

        def log_message(self, *_: Any) -> None:
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        provider = EmulatedProvider(f"http://127.0.0.1:{server.server_port}", now)
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        yield provider
        server.shutdown()
        thread.join()
