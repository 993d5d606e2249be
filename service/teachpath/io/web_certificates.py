"""The certificate of the web port, for https: an authority of the station's own, and what it has signed.

The folder has authority.pem, which devices are to trust, station.pem with the names and addresses of the station, and
both private keys, for their owner alone. The authority can vouch for the station's names and for addresses and names
of private networks, and for nothing else: who steals its key cannot pass for other sites.
"""

from __future__ import annotations

import ipaddress
from collections.abc import Collection, Sequence
from datetime import datetime, timedelta
from pathlib import Path
from typing import Final

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from teachpath.errors import UnusableSettings
from teachpath.io.bus_access import RENEWAL
from teachpath.io.certificates import certificate_builder, general_name, key_usage, write_pair
from teachpath.io.private_files import refuse_shared

AUTHORITY: Final = "authority"
STATION: Final = "station"
AUTHORITY_LIFE: Final = timedelta(days=3650)
LIFE: Final = timedelta(days=397)  # browsers trust none that holds longer
CREATE_COMMAND: Final = "teachpath tls init"
# What the authority may vouch for beside the names it is given: hosts that are on no public network.
PRIVATE_NAMES: Final = ("localhost", "local", "lan", "internal", "home.arpa")
PRIVATE_NETWORKS: Final = (
    "127.0.0.0/8",
    "10.0.0.0/8",
    "172.16.0.0/12",
    "192.168.0.0/16",
    "169.254.0.0/16",
    "::1/128",
    "fc00::/7",
    "fe80::/10",
)


def prepare_web_authority(folder: Path, hosts: Collection[str], now: datetime) -> bool:
    """Make the authority where there is none that may vouch for all hosts long enough; returns whether it was made.

    Raises:
        UnusableSettings: the folder cannot be written, or holds what is no authority.
    """
    path = folder / f"{AUTHORITY}.pem"
    if path.exists():
        there = _read(path)
        if there.not_valid_after_utc - now > RENEWAL and all(_may_vouch(there, host) for host in hosts):
            return False
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, f"teachpath authority of {now:%Y-%m-%d}")])
    builder = certificate_builder(name, name, key, now, AUTHORITY_LIFE)
    builder = builder.add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
    builder = builder.add_extension(key_usage(signs=True), critical=True)
    builder = builder.add_extension(x509.NameConstraints(_permitted(hosts), None), critical=True)
    builder = builder.add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
    write_pair(folder, AUTHORITY, builder.sign(key, hashes.SHA256()), key)
    return True


def issue_web_certificate(folder: Path, hosts: Sequence[str], now: datetime) -> datetime:
    """Sign a certificate for these names and addresses, in place of the former one, and return when it ends.

    Raises:
        UnusableSettings: there is no authority or its key cannot be used, or the folder cannot be written.
    """
    issuer, issuer_key = _read(folder / f"{AUTHORITY}.pem"), _read_key(folder / f"{AUTHORITY}.key")
    key = ec.generate_private_key(ec.SECP256R1())
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "teachpath station")])
    builder = certificate_builder(subject, issuer.subject, key, now, min(LIFE, issuer.not_valid_after_utc - now))
    builder = builder.add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
    builder = builder.add_extension(key_usage(signs=False), critical=True)
    builder = builder.add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
    names = x509.SubjectAlternativeName([general_name(host) for host in hosts])
    builder = builder.add_extension(names, critical=False)
    builder = builder.add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
    by = x509.AuthorityKeyIdentifier.from_issuer_public_key(issuer_key.public_key())
    builder = builder.add_extension(by, critical=False)
    made = builder.sign(issuer_key, hashes.SHA256())
    write_pair(folder, STATION, made, key)
    return made.not_valid_after_utc


def web_hosts(folder: Path) -> list[str]:
    """Return the names and addresses of the certificate in a folder; none where there is none."""
    path = folder / f"{STATION}.pem"
    if not path.exists():
        return []
    try:
        names = _read(path).extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return []
    return [str(name.value) for name in names]


def web_expiry(folder: Path) -> datetime:
    """Return when the certificate in a folder ends; raises UnusableSettings where it cannot be read."""
    return _read(folder / f"{STATION}.pem").not_valid_after_utc


def _permitted(hosts: Collection[str]) -> list[x509.GeneralName]:
    networks = [ipaddress.ip_network(network) for network in PRIVATE_NETWORKS]
    names = list(PRIVATE_NAMES)
    for host in hosts:
        try:
            networks.append(ipaddress.ip_network(host))
        except ValueError:
            names.append(host)
    return [*(x509.DNSName(name) for name in names), *(x509.IPAddress(network) for network in networks)]


def _may_vouch(authority: x509.Certificate, host: str) -> bool:
    try:
        permitted = authority.extensions.get_extension_for_class(x509.NameConstraints).value.permitted_subtrees or []
    except x509.ExtensionNotFound:
        return True
    try:
        address = ipaddress.ip_network(host)
    except ValueError:
        pass
    else:
        networks = [ipaddress.ip_network(str(each.value)) for each in permitted if isinstance(each, x509.IPAddress)]
        return any(address.version == each.version and address.subnet_of(each) for each in networks)  # type: ignore[arg-type]
    domains = [each.value for each in permitted if isinstance(each, x509.DNSName)]
    return any(host == domain or host.endswith(f".{domain}") for domain in domains)


def _read(path: Path) -> x509.Certificate:
    try:
        return x509.load_pem_x509_certificate(path.read_bytes())
    except (OSError, ValueError) as error:
        raise UnusableSettings(
            f"{path} is no certificate in PEM that can be read ({error}); make it with: {CREATE_COMMAND}"
        ) from None


def _read_key(path: Path) -> ec.EllipticCurvePrivateKey:
    try:
        status, content = path.stat(), path.read_bytes()
        key = serialization.load_pem_private_key(content, password=None)
    except (OSError, ValueError, TypeError) as error:
        raise UnusableSettings(
            f"the private key {path} cannot be used ({error}); move the folder away, then: {CREATE_COMMAND}"
        ) from None
    refuse_shared(
        f"the private key {path}",
        status,
        f"whoever has read it can pass for the station; remove it, then: {CREATE_COMMAND}",
    )
    if not isinstance(key, ec.EllipticCurvePrivateKey):
        raise UnusableSettings(f"{path} is no key that {CREATE_COMMAND} made; name another folder in web.tls")
    return key
