"""tls: https for the web port, by an authority of the station's own."""

from __future__ import annotations

from datetime import UTC, datetime
from ipaddress import ip_address
from typing import TYPE_CHECKING, Annotated

import typer

from teachpath.commands.audit import note
from teachpath.commands.options import Config, Data, Json, settings_of
from teachpath.commands.printing import print_answer
from teachpath.errors import UnusableInput

if TYPE_CHECKING:
    from teachpath.web.settings import WebSettings

app: typer.Typer = typer.Typer(help="https for page and REST: make or renew the certificate.", no_args_is_help=True)
LOOPBACK = ("localhost", "127.0.0.1", "::1")
UNSPECIFIED_HOSTS = ("0.0.0.0", "::", "")


@app.callback()
def group() -> None:
    """Keep `init` a command of a group."""


@app.command("init")
def init(
    name: Annotated[
        list[str] | None, typer.Option(help="Name under which the station is reached; may be repeated.")
    ] = None,
    address: Annotated[list[str] | None, typer.Option(help="IP address of the station; may be repeated.")] = None,
    config: Config = None,
    data: Data = None,
    json_: Json = False,
) -> None:
    """Make a certificate for the web port, or renew it, and an authority that vouches for it.

    `teachpath serve` speaks https from its next start; a service that speaks https takes up a renewed certificate by
    itself. The certificate is for loopback, this machine's name, web.host, web.hosts, what the former one was for, and
    what is named here.
    """
    from teachpath.io import web_certificates as files
    from teachpath.io.private_files import make_private, write_private
    from teachpath.web.certificate import certificate_folder
    from teachpath_proto.authorities import authorities_folder

    settings, now = settings_of(config, data), datetime.now(UTC)
    folder = certificate_folder(settings.web, settings.store.data_dir)
    hosts = _hosts(settings.web, [*files.web_hosts(folder), *(name or []), *map(_address, address or [])])
    make_private(folder)
    made = files.prepare_web_authority(folder, hosts, now)
    expiry = files.issue_web_certificate(folder, hosts, now)
    authority = (folder / f"{files.AUTHORITY}.pem").read_text()
    import hashlib

    known_as = hashlib.sha256(str(folder.absolute()).encode()).hexdigest()[:16]
    write_private(authorities_folder() / f"{known_as}.pem", authority)
    note(settings, f"make a certificate for {', '.join(hosts)}")
    missing = [host for host in hosts if host not in (*LOOPBACK, *settings.web.hosts, settings.web.host)]
    said = {
        "expires_ns": round(expiry.timestamp()) * 1_000_000_000,
        "hosts": hosts,
        "missing_hosts": missing,
        "authority": f"{folder / files.AUTHORITY}.pem",
        "authority_made": made,
        "fingerprint": fingerprint(authority),
    }
    sentences = [
        f"certificate valid until {expiry:%Y-%m-%d}, for {', '.join(hosts)}",
        f"authority {'made' if made else 'as before'}: {said['authority']}",
        f"fingerprint (SHA-256): {said['fingerprint']}",
        "Devices trust the station when they trust that file: the page offers it, with the steps, at /authority.",
    ]
    if missing:
        sentences.append(f"It answers under those names only that web.hosts lists; not there yet: {', '.join(missing)}")
    print_answer(said, *sentences, json_=json_)


def fingerprint(authority: str) -> str:
    """Return the SHA-256 of a certificate in PEM, as devices show it."""
    import hashlib
    import ssl

    return hashlib.sha256(ssl.PEM_cert_to_DER_cert(authority)).digest().hex(":").upper()


def _hosts(settings: WebSettings, further: list[str]) -> list[str]:
    """Return every name and address of the certificate once, in order."""
    import socket

    here = [socket.gethostname().lower()]
    bound = [] if settings.host in UNSPECIFIED_HOSTS else [settings.host]
    hosts = [*LOOPBACK, *here, *bound, *settings.hosts, *further]
    for host in hosts:
        if not _is_host(host):
            raise UnusableInput(f"{host!r} is no host name and no address; name the station as browsers do")
    return list(dict.fromkeys(host.lower() for host in hosts))


def _is_host(host: str) -> bool:
    try:
        ip_address(host)
    except ValueError:
        labels = host.split(".")
        return len(host) <= 253 and all(
            label.isascii() and label.replace("-", "").replace("_", "").isalnum() and len(label) < 64
            for label in labels
        )
    return True


def _address(text: str) -> str:
    try:
        return str(ip_address(text))
    except ValueError:
        raise UnusableInput(f"--address {text} is no IP address; name a host with --name") from None
