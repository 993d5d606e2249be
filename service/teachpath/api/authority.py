"""What a device needs in order to trust the station's certificate: its authority, and a page with the steps."""

from __future__ import annotations

import hashlib
import io
import ssl

from fastapi import APIRouter, Request, Response

from teachpath.access.loopback import host_of, is_loopback
from teachpath.api.access import NO_CAPABILITY
from teachpath.api.parts import Parts
from teachpath.api.view import HEADERS, HTML
from teachpath.errors import NotFound
from teachpath.live.preview.asset_paths import web_files

PAGE = "authority.html"
FINGERPRINT = "<!-- fingerprint -->"  # where the page has that of the authority
ADDRESS = "<!-- address -->"  # and where a device reaches the page


def authority_router(parts: Parts) -> APIRouter:
    """Return the routes `/authority`, its certificate and the QR code of its address."""
    router = APIRouter(include_in_schema=False)

    def authority() -> str:
        found = parts.certificate.authority if parts.certificate else ""
        if not found:
            raise NotFound("this station has no authority of its own; teachpath tls init makes one, for https")
        return found

    def address(request: Request) -> str:
        """Return where another device reaches the page, by http: it does not trust the certificate yet."""
        host = host_of(request.headers.get("host", ""))
        if is_loopback(host):
            host = next((name for name in parts.settings.web.hosts if not is_loopback(name)), host)
        return f"http://{host}:{parts.settings.web.port}/authority"

    @router.get("/authority", dependencies=NO_CAPABILITY)
    def show_steps(request: Request) -> Response:
        """Show what a device does to trust this station, with the fingerprint to compare."""
        digest = hashlib.sha256(ssl.PEM_cert_to_DER_cert(authority())).digest().hex(":").upper()
        page = (web_files() / PAGE).read_text().replace(FINGERPRINT, digest).replace(ADDRESS, address(request))
        return Response(page, headers=HEADERS, media_type=HTML)

    @router.get("/authority.crt", dependencies=NO_CAPABILITY)
    def download_authority() -> Response:
        """Return the authority's certificate, which a device is to trust."""
        return Response(authority(), headers=HEADERS, media_type="application/x-x509-ca-cert")

    @router.get("/authority/address.svg", dependencies=NO_CAPABILITY)
    def show_code(request: Request) -> Response:
        """Draw the address of the steps as a QR code."""
        import segno

        authority()
        drawn = io.BytesIO()
        segno.make(address(request), micro=False).save(drawn, kind="svg", scale=5, light="#fff", svgclass=None)
        return Response(drawn.getvalue(), headers=HEADERS, media_type="image/svg+xml")

    return router
