"""Names of learning by the field's terms: a score's deviation, and the least mean silhouette of the settings."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None

SETTING = ("guard", "min_silhouette")
SCORE = ("departure", "deviation")

runs: sa.TableClause = sa.table("runs", sa.column("id", sa.String), sa.column("document", sa.JSON))
jobs: sa.TableClause = sa.table("jobs", sa.column("id", sa.String), sa.column("request", sa.JSON))


def upgrade() -> None:
    _rewrite(runs, "document", lambda run: _run(run, SETTING, SCORE))
    _rewrite(jobs, "request", lambda request: _job(request, SETTING))


def downgrade() -> None:
    _rewrite(runs, "document", lambda run: _run(run, SETTING[::-1], SCORE[::-1]))
    _rewrite(jobs, "request", lambda request: _job(request, SETTING[::-1]))


def _rewrite(table, column, rename):
    """Rename keys in the JSON documents of a table, one row at a time, for a run may hold megabytes."""
    connection = op.get_bind()
    for key in connection.execute(sa.select(table.c.id)).scalars().all():
        this = table.c.id == key
        before = connection.execute(sa.select(table.c[column]).where(this)).scalar_one()
        after = rename(before)
        if after != before:
            connection.execute(sa.update(table).where(this).values({column: after}))


def _run(run, setting, score):
    clusters = [
        {**cluster, "scores": [_renamed(each, *score) for each in cluster["scores"]]} for cluster in run["clusters"]
    ]
    return {**run, "clusters": clusters, "settings": _renamed(run["settings"], *setting)}


def _job(request, setting):
    return {**request, "settings": _renamed(request["settings"], *setting)} if "settings" in request else request


def _renamed(document, old, new):
    return {new if key == old else key: value for key, value in document.items()}
