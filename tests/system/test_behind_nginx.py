"""The page behind nginx, under TLS and a path of its own, by the configuration in deploy/."""

import datetime
import ipaddress
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

from tests.ports import free_ports
from tests.system.processes import Service
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

SAMPLE = Path(__file__).parents[2] / "deploy" / "nginx.conf"
ABSENT = "no nginx; get it with: sudo apt-get install nginx-light"
# What a distribution's own configuration has around a file of conf.d/, with all that nginx writes in its folder.
AROUND = """daemon off;
pid nginx.pid;
error_log stderr;
events {{}}
http {{
    access_log off;
    client_body_temp_path body; proxy_temp_path proxy; fastcgi_temp_path a; uwsgi_temp_path b; scgi_temp_path c;
    {sample}
}}
"""


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service that believes the proxy."""
    settings = {"TEACHPATH_AUTH__MODE": "proxy", "TEACHPATH_WEB__PROXIES": '["127.0.0.1"]'}
    with Service(tmp_path_factory.mktemp("station") / "data", **settings) as service:
        yield service


@pytest.fixture(scope="module")
def address(service: Service, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """Where nginx answers for the service."""
    program = shutil.which("nginx", path="/usr/sbin:/usr/bin:/usr/local/bin")
    if program is None:
        pytest.skip(ABSENT)
    folder, (port,) = tmp_path_factory.mktemp("nginx"), free_ports(1)
    certify(folder)
    sample = SAMPLE.read_text()
    for said, here in {
        "listen 443": f"listen 127.0.0.1:{port}",
        "lab.example;": "127.0.0.1;",
        "/etc/ssl/lab.example": str(folder / "station"),
        "127.0.0.1:8765": service.url.removeprefix("http://"),
    }.items():
        assert said in sample
        sample = sample.replace(said, here)
    configuration = folder / "nginx.conf"
    configuration.write_text(AROUND.format(sample=sample))
    command = [program, "-e", "stderr", "-p", str(folder), "-c", str(configuration)]
    checked = subprocess.run([*command, "-t"], capture_output=True, text=True, timeout=HANG)
    assert checked.returncode == 0, checked.stderr
    running = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    url = f"https://127.0.0.1:{port}/cell-3/"
    try:
        wait_until(lambda: answers(url), "nginx answers")
        yield url
    finally:
        running.terminate()
        _, said = running.communicate(timeout=HANG)
    assert "[error]" not in said, said


def certify(folder: Path) -> None:
    """Write a certificate for this machine that nobody else has signed, and its key."""
    key, now = ec.generate_private_key(ec.SECP256R1()), datetime.datetime.now(datetime.UTC)
    name = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, "station")])
    address = x509.SubjectAlternativeName([x509.IPAddress(ipaddress.ip_address("127.0.0.1"))])
    begun = x509.CertificateBuilder(name, name, key.public_key(), x509.random_serial_number()).add_extension(
        address, True
    )
    valid = begun.not_valid_before(now).not_valid_after(now + datetime.timedelta(days=1))
    (folder / "station.pem").write_bytes(valid.sign(key, hashes.SHA256()).public_bytes(serialization.Encoding.PEM))
    form = serialization.PrivateFormat.PKCS8, serialization.NoEncryption()
    (folder / "station.key").write_bytes(key.private_bytes(serialization.Encoding.PEM, *form))


def answers(url: str) -> bool:
    try:
        return httpx.get(f"{url}api/v1/health/live", verify=False, timeout=HANG, trust_env=False).is_success
    except httpx.TransportError:
        return False


def test_the_page_works_under_a_path(browser: Any, address: str) -> None:
    page = browser.new_page(ignore_https_errors=True)
    page.set_default_timeout(1000 * HANG)
    said: list[str] = []
    page.on("console", lambda message: said.append(f"{message.type}: {message.text}"))
    page.on("response", lambda answer: said.append(answer.url) if answer.status >= 400 else None)
    page.goto(address.rstrip("/"))  # nginx adds what is missing
    page.wait_for_selector("html[data-scene=ready]", state="attached")
    page.wait_for_function("() => teachpath.state().connection === 'live'")
    order = "fetch('api/v1/tasks/behind', {method: 'PUT', headers: {'Content-Type': 'application/json'}, body: '{}'})"
    assert page.evaluate(f"{order}.then((answer) => answer.ok)")
    page.wait_for_function("() => teachpath.state().tasks?.some((task) => task.name === 'behind')")
    page.goto(f"{address}docs")
    page.wait_for_selector("html[data-docs=ready]", state="attached")
    page.close()
    assert said == []


def test_an_order_of_another_origin_is_refused_there_as_well(address: str) -> None:
    for origin, status in (("https://elsewhere.example", 403), (address.removesuffix("/cell-3/"), 200)):
        answer = httpx.put(
            f"{address}api/v1/tasks/x", json={}, headers={"Origin": origin}, verify=False, trust_env=False
        )
        assert answer.status_code == status, answer.text
