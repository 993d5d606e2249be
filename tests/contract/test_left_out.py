"""Without a browser the last line of the tests says what was left out; where browser tests are asked for, they fail."""

import os
import subprocess
import sys
from pathlib import Path

BROWSER_TESTS = "def test_looks(browser): ...\ndef test_looks_again(browser): ...\ndef test_does_not_look(): ...\n"


def without_browser(folder: Path, **environment: str) -> tuple[int, str]:
    """Run three tests, two of which need a browser, where there is none; return the status and the last line."""
    (folder / "test_page.py").write_text(BROWSER_TESTS)
    (folder / "pytest.ini").write_text("[pytest]\n")
    clean = {name: value for name, value in os.environ.items() if name != "TEACHPATH_REQUIRE_BROWSER"}
    ended = subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "tests.conftest", "-p", "no:cacheprovider", str(folder)],
        env={**clean, "PATH": str(folder), "PYTHONPATH": str(Path(__file__).parents[2]), **environment},
        cwd=folder,
        capture_output=True,
        text=True,
    )
    return ended.returncode, ended.stdout.splitlines()[-1]


def test_the_last_line_says_that_browser_tests_were_left_out(tmp_path: Path) -> None:
    status, last = without_browser(tmp_path)
    assert status == 0
    assert last.startswith("browser tests left out: 2, no Chromium")


def test_it_fails_where_browser_tests_are_asked_for(tmp_path: Path) -> None:
    status, last = without_browser(tmp_path, TEACHPATH_REQUIRE_BROWSER="1")
    assert status == 1
    assert "2 errors" in last
