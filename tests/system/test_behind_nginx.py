"""The page behind nginx, under TLS and a path of its own or behind a login, by the configurations in deploy/."""

import datetime
import ipaddress
import shutil
import ssl
import subprocess
import threading
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import httpx
import pytest
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from tests.ports import free_ports
from tests.system.processes import Service
from tests.waiting import HANG, wait_until

pytestmark = pytest.mark.system

DEPLOY = Path(__file__).parents[2] / "deploy"
# Who has signed in at the emulated oauth2-proxy, by cookie, and the groups that it tells.
GROUPS = {"anna": "teachers,cell-3-operators", "otto": "students"}
LOGIN_HEADERS = {"Cookie": "login=anna"}
NO_NGINX = "no nginx; get it with: sudo apt-get install nginx-light"
# What a distribution's own configuration has around a file of conf.d/, with all that nginx writes in its folder.
NGINX_CONFIG = """daemon off;
pid nginx.pid;
error_log stderr;
events {{}}
http {{
    access_log off;
    client_body_temp_path body; proxy_temp_path proxy; fastcgi_temp_path a; uwsgi_temp_path b; scgi_temp_path c;
    {samples}
}}
"""


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    """A service that believes the proxy."""
    settings = {
        "TEACHPATH_AUTH__MODE": "proxy",
        "TEACHPATH_WEB__PROXIES": '["127.0.0.1"]',
        "TEACHPATH_PROXY__DEMONSTRATE": '["lab", "teachers"]',
        "TEACHPATH_PROXY__OPERATE": '["cell-3-operators"]',
    }
    with Service(tmp_path_factory.mktemp("station") / "data", **settings) as service:
        yield service


class OAuth2Proxy(BaseHTTPRequestHandler):
    """What nginx asks of oauth2-proxy."""

    def do_GET(self) -> None:
        name = self.headers.get("Cookie", "").removeprefix("login=")
        self.send_response({"/oauth2/auth": 202 if name in GROUPS else 401}.get(self.path, 200))
        if name in GROUPS:
            self.send_header("X-Auth-Request-Preferred-Username", name)
            self.send_header("X-Auth-Request-Groups", GROUPS[name])
        self.send_header("Content-Length", "0")
        self.end_headers()

    def log_message(self, *_: Any) -> None:
        pass


@pytest.fixture(scope="module")
def addresses(service: Service, tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, str]]:
    """Where nginx answers for the service, by the name of the sample."""
    program = shutil.which("nginx", path="/usr/sbin:/usr/bin:/usr/local/bin")
    if program is None:
        pytest.skip(NO_NGINX)
    folder, (first, second) = tmp_path_factory.mktemp("nginx"), free_ports(2)
    certify(folder)
    with ThreadingHTTPServer(("127.0.0.1", 0), OAuth2Proxy) as asking:
        threading.Thread(target=asking.serve_forever, daemon=True).start()
        here = {
            "lab.example;": "127.0.0.1;",
            "/etc/ssl/lab.example": str(folder / "station"),
            "127.0.0.1:8765": service.url.removeprefix("http://"),
        }
        asked = {"127.0.0.1:4180": f"127.0.0.1:{asking.server_port}"}
        lab = {'X-Forwarded-User ""': "X-Forwarded-User bench", 'X-Forwarded-Groups ""': "X-Forwarded-Groups lab"}
        samples = [
            filled("nginx.conf", here | lab | {"listen 443": f"listen 127.0.0.1:{first}"}),
            filled("nginx-oauth2.conf", here | asked | {"listen 443": f"listen 127.0.0.1:{second}"}),
        ]
        configuration = folder / "nginx.conf"
        configuration.write_text(NGINX_CONFIG.format(samples="\n".join(samples)))
        command = [program, "-e", "stderr", "-p", str(folder), "-c", str(configuration)]
        checked = subprocess.run([*command, "-t"], capture_output=True, text=True, timeout=HANG)
        assert checked.returncode == 0, checked.stderr
        running = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        found = {"path": f"https://127.0.0.1:{first}/cell-3/", "login": f"https://127.0.0.1:{second}/"}
        try:
            wait_until(lambda: answers(found["path"]), "nginx answers")
            yield found
        finally:
            running.terminate()
            _, said = running.communicate(timeout=HANG)
            asking.shutdown()
        assert "[error]" not in said, said


def filled(name: str, values: dict[str, str]) -> str:
    """Return a sample with the names and addresses of this machine."""
    sample = (DEPLOY / name).read_text()
    for said, value in values.items():
        assert said in sample
        sample = sample.replace(said, value)
    return sample


@pytest.fixture
def address(addresses: dict[str, str]) -> str:
    return addresses["path"]


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
        asking = {"headers": {"Origin": origin}, "verify": False, "trust_env": False, "timeout": HANG}
        answer = httpx.put(f"{address}api/v1/tasks/x", json={}, **asking)
        assert answer.status_code == status, answer.text


def test_oauth2_proxy_is_asked_before_everything_but_a_stop(addresses: dict[str, str]) -> None:
    address = addresses["login"]
    with httpx.Client(base_url=address, verify=False, trust_env=False, timeout=HANG) as client:
        page = client.get("")
        assert (page.status_code, page.headers["location"]) == (302, "/oauth2/start?rd=%2F")
        assert client.get("api/v1/tasks").status_code == 401
        assert client.get("oauth2/auth", headers=LOGIN_HEADERS).status_code == 404  # for nginx alone
        forged = {"X-Forwarded-User": "mallory"}
        assert client.get("api/v1/identity", headers=LOGIN_HEADERS | forged).json()["name"] == "anna"
        assert client.put("api/v1/tasks/asked", json={}, headers=LOGIN_HEADERS).status_code == 200
        stop = client.post("api/v1/stop", headers=forged)
        assert stop.status_code not in (302, 401, 403, 404), stop.text
    events = address.replace("https", "wss") + "api/v1/events"
    trusting = ssl._create_unverified_context()
    with connect(events, ssl=trusting, additional_headers=LOGIN_HEADERS) as socket:
        assert socket.recv(HANG)
    with pytest.raises(InvalidStatus) as found, connect(events, ssl=trusting):
        pass
    assert found.value.response.status_code == 401


def test_roles_follow_from_the_groups_that_oauth2_proxy_tells(addresses: dict[str, str]) -> None:
    names = ("X-Forwarded-User", "X-Forwarded-Groups", "X_Forwarded_Groups", "X-Auth-Request-Groups")
    forged = dict.fromkeys(names, "cell-3-operators")
    otto = {"Cookie": "login=otto"} | forged
    with httpx.Client(base_url=addresses["login"], verify=False, trust_env=False, timeout=HANG) as client:
        anna = client.get("api/v1/identity", headers=LOGIN_HEADERS | forged).json()
        assert (anna["name"], anna["groups"]) == ("anna", ["teachers", "cell-3-operators"])
        assert anna["capabilities"] == ["view", "demonstrate", "operate"]
        assert client.get("api/v1/identity", headers=otto).json()["capabilities"] == []
        refused = client.post("api/v1/lease", json={}, headers=otto)
        assert refused.status_code == 403
        assert "(X-Forwarded-Groups): students; whoever administers" in refused.json()["detail"]
        behind = client.get(f"{addresses['path']}api/v1/identity", headers=forged).json()
        assert (behind["name"], behind["groups"]) == ("bench", ["lab"])


def test_the_page_says_which_groups_it_was_told_and_what_is_missing(browser: Any, addresses: dict[str, str]) -> None:
    def opened(name: str) -> Any:
        context = browser.new_context(ignore_https_errors=True)
        context.add_cookies([{"name": "login", "value": name, "url": addresses["login"]}])
        page = context.new_page()
        page.set_default_timeout(1000 * HANG)
        page.goto(addresses["login"])
        return page

    page = opened("otto")
    page.wait_for_selector("#sign-in form")
    assert "you are otto. The proxy says that you are in: students. No role" in page.inner_text("#sign-in")
    assert page.is_visible("#stop")
    assert not any(page.is_visible(each) for each in ("main", "#sign-in input", "#sign-in button"))
    page.context.close()
    page = opened("anna")
    page.wait_for_function("() => teachpath.state().connection === 'live'")
    assert page.inner_text("#identity") == "anna"  # who signs out at the proxy, and not here
    assert page.get_attribute("#identity", "title") == "The proxy says that you are in: teachers, cell-3-operators."
    page.click("#tab-edit")
    page.wait_for_selector("#panel-edit .missing")
    assert "the role “teach”. The proxy says that you are in: teachers," in page.inner_text("#panel-edit .missing")
    page.context.close()
