"""Tables and rows of every former version become those of today, and back."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
import sqlalchemy as sa
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.migration import MigrationContext

from teachpath.errors import Conflict
from teachpath.io.documents import decode_demonstration, encode
from teachpath.io.store.store import Store
from teachpath.io.store.tables import NEWEST_REVISION, Base, DemonstrationRow, ExecutionTable, JobRow, PlanRow, RunTable
from teachpath.records import (
    Deviation,
    ExecutorStatus,
    StreamStatistics,
)
from tests.contract.rows import a_job, demonstration, learned
from tests.contract.stores import Open
from tests.unit.io.test_documents import a_plan


@contextmanager
def migrating(url: str, move: Callable[[Config, str], None], revision: str) -> Iterator[sa.Connection]:
    """Move the tables of a database to a revision; the connection sees them there."""
    engine = sa.create_engine(url)
    config = Config()
    config.set_main_option("script_location", "teachpath.io.store:migrations")
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        move(config, revision)
        yield connection
    engine.dispose()


def test_the_migrations_make_the_tables(store: Store, url: str) -> None:
    engine = sa.create_engine(url)
    with engine.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True, "compare_server_default": True})
        assert compare_metadata(context, Base.metadata) == []
        assert context.get_current_revision() == NEWEST_REVISION  # so that the next start has nothing to migrate
    engine.dispose()


def test_the_migrations_go_down_and_up_again(store: Store, url: str) -> None:
    with migrating(url, command.downgrade, "base") as connection:
        assert set(sa.inspect(connection).get_table_names()) == {"alembic_version"}
    with migrating(url, command.upgrade, "head") as connection:
        assert set(sa.inspect(connection).get_table_names()) == {"alembic_version", *Base.metadata.tables}
    assert store.tasks() == []


def test_tables_that_rows_refer_to_are_migrated_with_those_rows(store: Store, url: str, open_: Open) -> None:
    store.add_demonstration(demonstration("d"))
    store.add_job(a_job())
    run = store.finish_learning("learn-1", learned())
    path = store.run(run).learned.paths[0]
    with migrating(url, command.downgrade, "0008"):
        pass
    opened = open_()
    assert [row.id for row in opened.demonstrations("t")] == ["d"]
    assert encode(opened.path(path.id)) == encode(path)
    with pytest.raises(Conflict):  # and from then on a row must refer to one that is there
        opened.add_demonstration(demonstration("e", task="nowhere"))


def test_all_rows_go_down_to_the_first_tables_and_up_again(store: Store, url: str) -> None:
    store.add_demonstration(demonstration("d"))
    store.add_job(a_job())
    run = store.finish_learning("learn-1", learned())
    store.add_job(a_job("plan-1", kind="plan"))
    plan = store.finish_planning("plan-1", a_plan())
    store.put_execution("e", plan, ExecutorStatus(execution="e", activity="on the path"))

    def shown() -> list[object]:
        lists = [store.tasks(), store.demonstrations("t"), store.jobs(), store.lists.executions()]
        return [*lists, encode(store.run(run).learned), encode(store.plan(plan)), encode(store.path(f"{run}-2"))]

    before = shown()
    with migrating(url, command.downgrade, "0001"):
        pass
    with migrating(url, command.upgrade, "head"):
        pass
    assert shown() == before


def test_a_migration_renames_what_runs_and_jobs_say_of_learning(store: Store, url: str) -> None:
    store.add_job(a_job(request={"settings": {"keep": 3, "min_silhouette": 0.4}, "calibrations": {}}))
    found = replace(learned(), settings={"keep": 3, "min_silhouette": 0.4, "seed": 1})
    score = replace(found.clusters[0].scores[0], deviation=Deviation((0.2, 0.4), (1.0, 2.0), "stands still"))
    run = store.finish_learning("learn-1", replace(found, clusters=(replace(found.clusters[0], scores=(score,)),)))
    now = store.run(run).learned
    with migrating(url, command.downgrade, "0004") as connection:
        (before,) = connection.scalars(sa.select(RunTable.document))
        (request,) = connection.scalars(sa.select(JobRow.request))
    assert list(before["settings"].items()) == [("keep", 3), ("guard", 0.4), ("seed", 1)]
    assert before["clusters"][0]["scores"][0]["departure"]["sentence"] == "stands still"
    assert request == {"settings": {"keep": 3, "guard": 0.4}, "calibrations": {}}
    with migrating(url, command.upgrade, "head"):
        pass
    assert encode(store.run(run).learned) == encode(now)
    assert store.job("learn-1").request["settings"] == {"keep": 3, "min_silhouette": 0.4}


def test_a_migration_renames_what_demonstrations_say_of_their_samples(store: Store, url: str) -> None:
    statistics = StreamStatistics(received=9, outliers=2, level_shifts=1)
    now = store.add_demonstration(demonstration("d", statistics=statistics))
    with migrating(url, command.downgrade, "0006") as connection:
        (before,) = connection.scalars(sa.select(DemonstrationRow.document))
    assert "statistics" not in before
    assert [before["account"][name] for name in ("received", "jumps", "leaps")] == [9, 2, 1]
    assert decode_demonstration(json.dumps(before).encode()) == now  # so a file that was made then is read, too
    with migrating(url, command.upgrade, "head"):
        pass
    assert store.demonstration(now.id) == now


def test_a_migration_renames_what_plans_and_executions_say_of_motion(store: Store, url: str) -> None:
    store.add_job(a_job("plan-1", kind="plan"))
    plan, status = store.finish_planning("plan-1", a_plan()), ExecutorStatus(activity="on the path")
    store.put_execution("e", plan, status)
    now = store.plan(plan)
    with migrating(url, command.downgrade, "0007") as connection:
        (before,) = connection.scalars(sa.select(PlanRow.document))
        (execution,) = connection.scalars(sa.select(ExecutionTable.document))
    assert before["pace"] == now.squared_rates.tolist()
    assert "squared_rates" not in before
    assert (execution["stretch"], "activity" in execution) == ("on the path", False)
    with migrating(url, command.upgrade, "head"):
        pass
    assert store.execution("e").status == status
    assert np.array_equal(store.plan(plan).squared_rates, now.squared_rates)
