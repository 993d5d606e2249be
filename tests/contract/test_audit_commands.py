"""Every command of the command line that changes something by itself is in the audit log."""

from collections.abc import Iterator
from pathlib import Path

from typer.core import TyperGroup
from typer.main import get_command
from typer.testing import CliRunner

from teachpath.__main__ import app
from teachpath.io.audit_log import AuditLog
from teachpath.io.store.copying import without_password
from tests.contract.desk import csv

PASSWORD = "four words put together"
READERS = [
    "demonstrations",
    "status",
    "tasks",
    "runs",
    "paths",
    "plans",
    "jobs",
    "executions",
    "arms",
    "scenes",
    "evaluate",
    "diff",
    "export/demonstrations",
    "export/report",
    "export/plan",
    "export/execution",
    "curve/list",
    "curve/export",
    "curve/compare",
    "scene/show",
    "scene/versions",
    "arm/list",
    "arm/check",
    "login/list",
    "station/router",
    "audit/verify",
    "audit/export",
    "token/list",
    "person/list",
]
BY_REST = [
    "amend",
    "recalibrate",
    "learn",
    "recut",
    "plan",
    "adapt",
    "object",
    "run",
    "stop",
    "acknowledge",
    "curve/import",
    "scene/add",
    "scene/copy",
    "scene/remove",
    "scene/restore",
    "task/delete",
    "task/rename",
    "task/restore",
]
STARTS = ["serve", "demo", "worker", "executor", "simulator", "replay"]  # what the service that they belong to writes
WRITERS: dict[str, tuple[str, str]] = {  # in an order in which they can be given: words, and what is written
    "import": ("import boxes {folder}/motion.csv {data}", "import into boxes: 1 demonstrations of motion.csv"),
    "doctor": ("doctor {data}", "doctor: 0 faults found"),
    "arm/add": ("arm add six six-axis {data}", "add arm six@1 of six-axis, "),
    "backup": ("backup {folder}/copy {data}", "back up into {folder}/copy: 2 files"),
    "prune": ("prune --older-than 1 {data}", "prune what is older than 1 days: 0 removed"),
    "restore": ("restore {folder}/copy --replace {data}", "restore {folder}/copy, what was there is in "),
    "store/copy": ("store copy {folder}/data {folder}/other", "copy all rows from {folder}/data to {folder}/other"),
    "token/create": ("token create --role view --name cell-3 {data}", "create token cell-3, view, for 90 days"),
    "token/revoke": ("token revoke cell-3 {data}", "revoke token cell-3"),
    "person/add": ("person add anna --role teach {data}", "add person anna, teach"),
    "person/password": ("person password anna {data}", "change the password of anna"),
    "person/remove": ("person remove anna {data}", "remove person anna"),
    "tls/init": ("tls init {data}", "make a certificate for "),
    "station/certificates": ("station certificates {config}", "make certificates of the bus: service, "),
    "login/create": (
        "login create left --role tracker --into {folder}/left.json {config}",
        "create login left, tracker",
    ),
    "login/revoke": ("login revoke left {config}", "revoke login left"),
}


def configured(folder: Path) -> Path:
    """Write the settings of a station whose bus is over TLS, with its data in a folder that is not there yet."""
    settings = folder / "station.toml"
    bus = f'[bus]\nendpoint = "tls/127.0.0.1:7447"\ncertificates = "{folder}/certificates"\n'
    settings.write_text(f'{bus}[store]\ndata_dir = "{folder}/data"\n')
    return settings


def names(group: TyperGroup, before: str = "") -> Iterator[str]:
    for name, command in group.commands.items():
        if isinstance(command, TyperGroup):
            yield from names(command, f"{before}{name}/")
        else:
            yield before + name


def test_every_command_is_known_as_one_that_writes_or_does_not() -> None:
    group = get_command(app)
    assert isinstance(group, TyperGroup)
    assert sorted(names(group)) == sorted([*READERS, *BY_REST, *STARTS, *WRITERS])


def test_every_command_that_changes_something_is_written(tmp_path: Path) -> None:
    (tmp_path / "motion.csv").write_text(csv())
    words = {"folder": tmp_path, "data": f"--data {tmp_path}/data", "config": f"--config {configured(tmp_path)}"}
    log = AuditLog(tmp_path / "data")
    for order, written in WRITERS.values():
        before = len(list(log.entries()))
        result = CliRunner().invoke(app, order.format(**words).split(), input=f"{PASSWORD}\n")
        assert result.exit_code in (0, 3), (order, result.output, result.exception)  # 3: what was imported is rejected
        (entry,) = list(log.entries())[before:]
        assert entry.action.startswith(written.format(**words))
        assert (entry.source, entry.answer) == ("command line", "done")
    assert log.verify() == ""
    assert next(each.action for each in AuditLog(tmp_path / "other").entries()).startswith("copy all rows")


def test_a_password_of_a_database_is_not_written() -> None:
    assert without_password("postgresql+psycopg://user:secret@host/teachpath?password=secret") == (
        "postgresql+psycopg://user:***@host/teachpath"
    )
    assert without_password("elsewhere") == "elsewhere"


def test_where_there_is_no_log_it_is_said(tmp_path: Path) -> None:
    result = CliRunner().invoke(app, ["station", "certificates", "--config", str(configured(tmp_path))])
    assert f"not in an audit log: there is no data folder {tmp_path}/data" in result.stderr
