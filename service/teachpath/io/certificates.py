"""The certificates of a station's bus: one authority, and one certificate for every role and every further program.

A folder holds them in PEM, NAME.pem with its private key NAME.key, for its owner alone. The subject says who somebody
is: the name with its generation (common name), the role (organizational unit), and the one tracker or robot it may be
(DN qualifier).
"""

from __future__ import annotations

import ipaddress
import json
from collections.abc import Iterable, Sequence
from dataclasses import replace
from datetime import datetime, timedelta
from pathlib import Path
from typing import Final

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID, ObjectIdentifier

from teachpath.errors import UnusableSettings
from teachpath.io.bus_access import RENEWAL
from teachpath.io.private_files import refuse_shared, write_private
from teachpath_proto.logins import GENERATION_MARK, Login, Role

AUTHORITY: Final = "authority"
ISSUED_FILE: Final = "issued.json"  # newest generation of every name that has or had a certificate
AUTHORITY_LIFE: Final = timedelta(days=3650)
LIFE: Final = timedelta(days=365)
CLOCK_DIFFERENCE: Final = timedelta(hours=1)  # by which another machine's clock may be behind
LOOPBACK: Final = ("127.0.0.1", "localhost")
CREATE_COMMAND: Final = "teachpath station certificates"


def prepare_authority(folder: Path, now: datetime) -> bool:
    """Make the authority that signs a station's certificates, where there is none; returns whether it was made.

    Raises:
        UnusableSettings: the folder cannot be written.
    """
    if (folder / f"{AUTHORITY}.pem").exists():
        return False
    key = ec.generate_private_key(ec.SECP256R1())
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "teachpath authority")])
    builder = certificate_builder(name, name, key, now, AUTHORITY_LIFE)
    builder = builder.add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
    builder = builder.add_extension(key_usage(signs=True), critical=True)
    write_pair(folder, AUTHORITY, builder.sign(key, hashes.SHA256()), key)
    _write_file(folder / ISSUED_FILE, "{}")
    return True


def issue(folder: Path, who: Login, now: datetime, *, hosts: Sequence[str] = ()) -> Login:
    """Make a certificate and a private key, in place of those that there are, and return the login with them.

    A renewed certificate has the common name of the one in its place. Where that is gone, because it was revoked or
    removed, the new one has a further generation in its common name: whoever still has the old one gains nothing by it.

    Args:
        folder: of the authority; the files are written there.
        who: name, role, and the one tracker or robot it may be.
        now: from when it is valid, with a time zone.
        hosts: addresses and names at which the holder may listen. Without any it may only connect, so that a stolen
            one does not serve to play the station.

    Raises:
        UnusableSettings: there is no authority, or it ends soon, others may read its key, or the folder cannot be
            written.
    """
    issuer, issuer_key = _authority(folder, now)
    who = replace(who, generation=_next_generation(folder, who.user))
    key = ec.generate_private_key(ec.SECP256R1())
    builder = certificate_builder(_subject(who), issuer.subject, key, now, min(LIFE, issuer.not_valid_after_utc - now))
    builder = builder.add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
    builder = builder.add_extension(key_usage(signs=False), critical=True)
    purposes: list[ObjectIdentifier] = [ExtendedKeyUsageOID.CLIENT_AUTH]
    if hosts:
        purposes.append(ExtendedKeyUsageOID.SERVER_AUTH)
        names = x509.SubjectAlternativeName([general_name(host) for host in sorted(set(hosts))])
        builder = builder.add_extension(names, critical=False)
    builder = builder.add_extension(x509.ExtendedKeyUsage(purposes), critical=False)
    write_pair(folder, who.user, builder.sign(issuer_key, hashes.SHA256()), key)
    return read_login(folder, who.user)


def read_login(folder: Path, name: str) -> Login:
    """Read one certificate, with its private key where that is there, too, and the authority's certificate.

    Raises:
        UnusableSettings: it is not there or cannot be read, or others may read its key.
    """
    pem, key = folder / f"{name}.pem", folder / f"{name}.key"
    certificate = _certificate(pem)
    try:
        role, only = (
            Role(_field(certificate, NameOID.ORGANIZATIONAL_UNIT_NAME)),
            _field(certificate, NameOID.DN_QUALIFIER),
        )
    except ValueError as error:
        raise UnusableSettings(f"{pem} names no role of a station ({error}); make another: {CREATE_COMMAND}") from None
    private = _read_key(key) if key.exists() else ""
    user, generation = _name_and_generation(certificate)
    authority = _read(folder / f"{AUTHORITY}.pem")
    return Login(user, "", role, only, _read(pem), private, authority, generation)


def read_logins(folder: Path) -> list[Login]:
    """Read all certificates of a folder but the authority's; raises UnusableSettings as `read_login`."""
    return [read_login(folder, file.stem) for file in sorted(folder.glob("*.pem")) if file.stem != AUTHORITY]


def expiry(login: Login) -> datetime:
    """Return when the certificate of a login ends."""
    return x509.load_pem_x509_certificate(login.certificate.encode()).not_valid_after_utc


def hosts_of(login: Login) -> list[str]:
    """Return the addresses and names at which the holder of a certificate may listen."""
    certificate = x509.load_pem_x509_certificate(login.certificate.encode())
    try:
        names = certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return []
    return [str(name.value) for name in names]


def refuse_expired(logins: Iterable[Login], now: datetime) -> None:
    """Raise UnusableSettings where a certificate has ended."""
    for login in logins:
        if expiry(login) <= now:
            raise UnusableSettings(
                f"the certificate of {login.user} ended on {expiry(login):%Y-%m-%d}; renew it with: {CREATE_COMMAND}"
            )


def _authority(folder: Path, now: datetime) -> tuple[x509.Certificate, ec.EllipticCurvePrivateKey]:
    path = folder / f"{AUTHORITY}.key"
    try:
        key = serialization.load_pem_private_key(_read_key(path).encode(), password=None)
    except ValueError:
        key = None
    if not isinstance(key, ec.EllipticCurvePrivateKey):
        raise UnusableSettings(f"{path} is no key that {CREATE_COMMAND} made; name another folder in bus.certificates")
    certificate = _certificate(folder / f"{AUTHORITY}.pem")
    if (end := certificate.not_valid_after_utc) - now <= RENEWAL:
        raise UnusableSettings(
            f"the authority in {folder} ends on {end:%Y-%m-%d} and signs no further: move the folder away, then make "
            f"all certificates anew with: {CREATE_COMMAND}"
        )
    return certificate, key


def certificate_builder(
    subject: x509.Name, issuer: x509.Name, key: ec.EllipticCurvePrivateKey, now: datetime, life: timedelta
) -> x509.CertificateBuilder:
    """Return what every certificate of a station has: whose it is, by whom signed, and from when for how long."""
    return (
        x509.CertificateBuilder()
        .subject_name(subject)
        .issuer_name(issuer)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - CLOCK_DIFFERENCE)
        .not_valid_after(now + life)
    )


def _next_generation(folder: Path, name: str) -> int:
    """Return the generation of the next certificate of a name, and note it; raises UnusableSettings."""
    path = folder / ISSUED_FILE
    try:
        issued: dict[str, int] | None = {one: int(number) for one, number in json.loads(path.read_text()).items()}
    except FileNotFoundError:
        issued = None  # whether there was one of this name before, nothing tells
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise UnusableSettings(
            f"{path} does not say which certificates there were ({error}); remove it, and names without a certificate "
            "get one of a further generation"
        ) from None
    if (folder / f"{name}.pem").exists():
        generation = _name_and_generation(_certificate(folder / f"{name}.pem"))[1]
    else:
        generation = 2 if issued is None else issued.get(name, 0) + 1
    _write_file(path, json.dumps({**(issued or {}), name: generation}, indent=1))
    return generation


def _name_and_generation(certificate: x509.Certificate) -> tuple[str, int]:
    name, _, number = _field(certificate, NameOID.COMMON_NAME).partition(GENERATION_MARK)
    return name, int(number or 1)


def _subject(who: Login) -> x509.Name:
    fields = [(NameOID.COMMON_NAME, who.common_name), (NameOID.ORGANIZATIONAL_UNIT_NAME, who.role.value)]
    fields += [(NameOID.DN_QUALIFIER, who.only)] if who.only else []
    return x509.Name([x509.NameAttribute(oid, value) for oid, value in fields])


def key_usage(*, signs: bool) -> x509.KeyUsage:
    """Return what a key is for: signing certificates, or showing whose it is."""
    return x509.KeyUsage(
        digital_signature=not signs,
        key_cert_sign=signs,
        crl_sign=signs,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        encipher_only=False,
        decipher_only=False,
    )


def general_name(host: str) -> x509.GeneralName:
    """Return a host as certificates have it: as an address where it is one, else as a name."""
    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        return x509.DNSName(host)


def _field(certificate: x509.Certificate, oid: ObjectIdentifier) -> str:
    found = certificate.subject.get_attributes_for_oid(oid)
    return str(found[0].value) if found else ""


def write_pair(folder: Path, name: str, certificate: x509.Certificate, key: ec.EllipticCurvePrivateKey) -> None:
    """Write NAME.key and NAME.pem, for their owner alone; raises UnusableSettings."""
    private = key.private_bytes(
        serialization.Encoding.PEM, serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    )
    _write_file(folder / f"{name}.key", private.decode())
    _write_file(folder / f"{name}.pem", certificate.public_bytes(serialization.Encoding.PEM).decode())


def _write_file(path: Path, content: str) -> None:
    try:
        write_private(path, content)
    except OSError as error:
        raise UnusableSettings(
            f"cannot write certificates into {path.parent}: {error.strerror}; name another"
        ) from None


def _certificate(path: Path) -> x509.Certificate:
    try:
        return x509.load_pem_x509_certificate(_read(path).encode())
    except ValueError as error:
        raise UnusableSettings(f"{path} is no certificate in PEM ({error}); make another: {CREATE_COMMAND}") from None


def _read_key(path: Path) -> str:
    content = _read(path)
    consequence = (
        f"whoever has read it can take its holder's place; remove it and {path.stem}.pem and make another: "
        f"{CREATE_COMMAND}"
    )
    refuse_shared(f"the private key {path}", path.stat(), consequence)
    return content


def _read(path: Path) -> str:
    try:
        return path.read_text()
    except FileNotFoundError:
        raise UnusableSettings(
            f"there is no {path}; make the certificates of the station with: {CREATE_COMMAND}"
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise UnusableSettings(f"cannot read {path}: {error}; it has to be this user's, in PEM") from None
