"""The certificate of the web port: what https needs, and what an operator should know of it."""

from __future__ import annotations

import ssl
from datetime import datetime
from pathlib import Path
from typing import Final

from teachpath.errors import UnusableSettings
from teachpath.io.bus_access import RENEWAL
from teachpath.io.private_files import refuse_shared
from teachpath.web.settings import WebSettings

DEFAULT_FOLDER: Final = "tls"  # in the data folder
CERTIFICATE: Final = "station.pem"
KEY: Final = "station.key"
AUTHORITY: Final = "authority.pem"  # only there where the station has made it
RENEW: Final = "renew it with: teachpath tls init"


def certificate_folder(settings: WebSettings, data_dir: str) -> Path:
    """Return the folder where the certificate of the web port is, or would be."""
    return Path(settings.tls) if settings.tls else Path(data_dir) / DEFAULT_FOLDER


def has_certificate(settings: WebSettings, data_dir: str) -> bool:
    """Tell whether the web port is to speak https: its folder is named, or has a certificate."""
    return bool(settings.tls) or (certificate_folder(settings, data_dir) / CERTIFICATE).exists()


def find_certificate(settings: WebSettings, data_dir: str) -> WebCertificate | None:
    """Return the certificate of the web port, or None where it speaks http; raises UnusableSettings."""
    return WebCertificate(certificate_folder(settings, data_dir)) if has_certificate(settings, data_dir) else None


class WebCertificate:
    """The certificate of the web port, with its key; a renewed one is taken up while the service runs.

    Attributes:
        context: for the server.

    Raises:
        UnusableSettings: files are missing, cannot be read or do not belong together, or others may read the key.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._stamp = self._newest()
        self.context: ssl.SSLContext = _context(folder)
        self._expiry = self._read_expiry()

    @property
    def authority(self) -> str:
        """Certificate of the authority that devices are to trust, in PEM; empty where the station has none."""
        try:
            return (self._folder / AUTHORITY).read_text()
        except (OSError, UnicodeDecodeError):
            return ""

    def notes(self, now: datetime) -> list[str]:
        """Take up a renewed certificate, and say what an operator should know."""
        try:
            if (stamp := self._newest()) != self._stamp:
                _context(self._folder)  # what cannot be used must not spoil what runs
                self.context.load_cert_chain(self._folder / CERTIFICATE, self._folder / KEY, _no_password)
                self._expiry, self._stamp = self._read_expiry(), stamp
        except (OSError, UnusableSettings) as error:
            return [f"the former certificate of the web port is still used: {error}"]
        if now >= self._expiry:
            return [
                f"the certificate of the web port ended on {self._expiry:%Y-%m-%d}, and browsers refuse it; {RENEW}"
            ]
        if self._expiry - now < RENEWAL:
            return [f"the certificate of the web port ends on {self._expiry:%Y-%m-%d}; {RENEW}"]
        return []

    def _newest(self) -> tuple[int, ...]:
        try:
            return tuple((self._folder / name).stat().st_mtime_ns for name in (CERTIFICATE, KEY))
        except OSError as error:
            raise UnusableSettings(
                f"cannot read the certificate {error.filename} ({error.strerror}); make it with teachpath tls init, "
                "or leave web.tls out"
            ) from None

    def _read_expiry(self) -> datetime:
        from teachpath.io.web_certificates import web_expiry  # loads cryptography, which http does without

        return web_expiry(self._folder)


def _context(folder: Path) -> ssl.SSLContext:
    key = folder / KEY
    refuse_shared(f"the private key {key}", key.stat(), "whoever has read it can pass for the station; make another")
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    context.set_alpn_protocols(["http/1.1"])
    # A ticket comes after the handshake, when a program may already write; one that reads on another thread, as of
    # Python's synchronous WebSockets, hangs now and then.
    context.num_tickets = 0
    try:
        context.load_cert_chain(folder / CERTIFICATE, key, _no_password)
    except (OSError, ValueError) as error:
        raise UnusableSettings(
            f"{folder / CERTIFICATE} and {key} are no certificate with its private key, in PEM and without a password "
            f"({error}); make both with teachpath tls init, or leave web.tls out"
        ) from None
    return context


def _no_password() -> bytes:
    return b""  # else OpenSSL asks on the terminal
