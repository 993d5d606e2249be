"""What a machine lacks for a station: each finding at its limit, and all of them on this machine."""

import socket
from pathlib import Path

import pytest

from teachpath.offline import system_check
from teachpath.offline.system_check import SystemFinding, examine_system

LACKING_FINDINGS = {
    "cores": system_check.judge_cores(system_check.LEAST_CORES - 1),
    "memory": system_check.judge_memory(system_check.LEAST_MEMORY - 1),
    "disk": system_check.judge_disk(Path("data"), system_check.LEAST_DISK - 1),
    "real-time": system_check.judge_realtime("Operation not permitted"),
    "timer": system_check.judge_sleeps([0.0, 1.01 * system_check.LONGEST_OVERSLEEP]),
    "port": system_check.judge_port("web.port", "127.0.0.1", 8765, free=False, running=[]),
    "browser": system_check.judge_browser(""),
    "nginx": system_check.judge_nginx(""),
}
FINE_FINDINGS = {
    "cores": system_check.judge_cores(system_check.LEAST_CORES),
    "memory": system_check.judge_memory(system_check.LEAST_MEMORY),
    "disk": system_check.judge_disk(Path("data"), system_check.LEAST_DISK),
    "real-time": system_check.judge_realtime(""),
    "timer": system_check.judge_sleeps([0.0, system_check.LONGEST_OVERSLEEP]),
    "port": system_check.judge_port("web.port", "127.0.0.1", 8765, free=True, running=[]),
    "own port": system_check.judge_port("web.port", "127.0.0.1", 8765, free=False, running=["http://127.0.0.1:8765"]),
    "browser": system_check.judge_browser("/usr/bin/chromium"),
    "nginx": system_check.judge_nginx("/usr/sbin/nginx"),
}


@pytest.mark.parametrize("finding", LACKING_FINDINGS.values(), ids=LACKING_FINDINGS)
def test_what_is_lacking_is_said_with_the_way_out(finding: SystemFinding) -> None:
    assert finding.lacking
    assert any(way in finding.sentence for way in ("; end", "; learn", "; free", "; allow", ": end", "sudo apt-get"))


@pytest.mark.parametrize("finding", FINE_FINDINGS.values(), ids=FINE_FINDINGS)
def test_what_is_there_lacks_nothing(finding: SystemFinding) -> None:
    assert not finding.lacking
    assert finding.sentence


def test_all_is_looked_at_and_nothing_is_made(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        findings = list(examine_system(tmp_path / "none", [("web.port", "127.0.0.1", port)], []))
    assert len({finding.name for finding in findings}) == len(findings)
    assert {"cores", "disk", "real-time scheduling", "timer", "Chromium", "nginx"} < {each.name for each in findings}
    assert [each.lacking for each in findings if each.name == f"port {port}"] == [True]
    assert list(tmp_path.iterdir()) == []
