"""The samples in deploy/ are what they say, as far as it can be told without a cluster."""

import re
import shlex
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest
import typer.main

from teachpath.__main__ import app
from tests.waiting import HANG

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "deploy"


def unit() -> dict[str, str]:
    """Directives of the systemd unit."""
    lines = (DEPLOY / "teachpath.service").read_text().splitlines()
    return dict(line.split("=", 1) for line in lines if re.match(r"\w+=", line))


def dockerfile() -> list[str]:
    """Instructions of the Dockerfile, each on one line."""
    text = (DEPLOY / "Dockerfile").read_text().replace("\\\n", " ")
    return [line for line in text.splitlines() if line and not line.startswith("#")]


@pytest.mark.parametrize("name", ["teachpath.service", "teachpath-ros2.service"])
def test_systemd_takes_the_unit(name: str) -> None:
    program = shutil.which("systemd-analyze")
    if program is None:
        pytest.skip("no systemd-analyze; get it with: sudo apt-get install systemd")
    command = [program, "verify", str(DEPLOY / name)]
    said = subprocess.run(command, capture_output=True, text=True, timeout=HANG).stderr
    faults = [line for line in said.splitlines() if "is not executable" not in line]  # it is not installed here
    assert [line for line in faults if name in line] == []


def test_the_unit_gives_the_service_no_more_than_it_needs() -> None:
    given = unit()
    assert given["DynamicUser"] == "yes"
    assert given["UMask"] == "0077"
    assert given["StateDirectoryMode"] == "0700"
    assert given["ProtectSystem"] == "strict"
    assert given["NoNewPrivileges"] == "yes"
    assert given["CapabilityBoundingSet"] == ""
    assert "AF_PACKET" not in given["RestrictAddressFamilies"]
    assert {"LimitRTPRIO", "MemoryMax"} <= given.keys()


@pytest.mark.parametrize("words", [unit()["ExecStart"], dockerfile()[-1].removeprefix("CMD ")])
def test_the_command_exists_with_its_options(words: str) -> None:
    _, *options = [word for word in shlex.split(words.strip("[]").replace(",", " ")) if not word.endswith("teachpath")]
    known = {option for one in typer.main.get_command(app).commands["serve"].params for option in one.opts}  # type: ignore[attr-defined]
    assert {word for word in options if word.startswith("--")} <= known


def test_the_container_runs_as_nobody_in_particular_and_installs_by_hash() -> None:
    said = dockerfile()
    users = [line.split()[1] for line in said if line.startswith("USER ")]
    assert users
    assert all(user.isdigit() and int(user) >= 10_000 for user in users)
    installs = [line for line in said if "pip install" in line]
    assert all("--require-hashes -r requirements/service.txt" in line for line in installs)
    for line in said:
        if line.startswith("COPY ") and "--from" not in line:
            assert (ROOT / line.split()[1]).exists()


def test_each_sample_says_how_it_was_checked() -> None:
    rows = (DEPLOY / "README.md").read_text()
    files = {each.name for each in DEPLOY.iterdir()} - {"README.md"}
    assert [name for name in sorted(files) if not re.search(rf"^\|.*`{re.escape(name)}/?`", rows, re.MULTILINE)] == []


def test_caddy_takes_its_sample(tmp_path: Path) -> None:
    program = shutil.which("caddy")
    if program is None:
        pytest.skip("no caddy; get it with: sudo apt-get install caddy")
    command = [program, "validate", "--config", str(DEPLOY / "Caddyfile"), "--adapter", "caddyfile"]
    environment = {"HOME": str(tmp_path), "XDG_DATA_HOME": str(tmp_path)}
    done = subprocess.run(command, capture_output=True, text=True, timeout=HANG, env=environment)
    assert done.returncode == 0, done.stderr


def test_oauth2_proxy_asks_nginx_s_station_and_its_cookie_is_of_the_host_alone() -> None:
    said = tomllib.loads((DEPLOY / "oauth2-proxy.cfg").read_text())
    assert f"proxy_pass http://{said['http_address']};" in (DEPLOY / "nginx-oauth2.conf").read_text()
    assert said["reverse_proxy"]
    assert said["set_xauthrequest"]  # else nginx would hear neither name nor groups
    assert said["code_challenge_method"] == "S256"
    assert (said["cookie_secure"], said["cookie_httponly"]) == (True, True)
    assert said["cookie_name"].startswith("__Host-")
    assert not any(name in said for name in ("client_secret", "cookie_secret"))  # in files of their own


@pytest.mark.parametrize("name", ["nginx.conf", "nginx-oauth2.conf", "Caddyfile"])
def test_a_proxy_tells_the_address_that_it_sees_and_not_what_it_was_told(name: str) -> None:
    said = (DEPLOY / name).read_text()
    assert re.search(r"X-Forwarded-For (\$remote_addr;|\{remote_host\})", said)
    assert "127.0.0.1:8765" in said


@pytest.mark.parametrize("name", ["nginx.conf", "nginx-oauth2.conf", "Caddyfile"])
def test_a_proxy_hands_on_neither_name_nor_groups_of_which_a_client_tells(name: str) -> None:
    said = re.sub(r"#.*", "", (DEPLOY / name).read_text())
    for header in ("User", "Groups"):
        assert len(re.findall(rf"(proxy_set_header |header_up -?)X-Forwarded-{header}\b", said)) == 1
    assert "$remote_user" not in said or "auth_basic " in said  # else it is what anybody claims
