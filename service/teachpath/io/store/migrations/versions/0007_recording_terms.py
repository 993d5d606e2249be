"""Names of recording by the field's terms: a demonstration's statistics, with its outliers and level shifts."""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"
branch_labels = None
depends_on = None

STATISTICS = {"account": "statistics"}
COUNTS = {"jumps": "outliers", "leaps": "level_shifts"}

demonstrations: sa.TableClause = sa.table("demonstrations", sa.column("id", sa.String), sa.column("document", sa.JSON))


def upgrade() -> None:
    _rewrite(STATISTICS, COUNTS)


def downgrade() -> None:
    _rewrite(*({new: old for old, new in names.items()} for names in (STATISTICS, COUNTS)))


def _rewrite(statistics, counts):
    connection = op.get_bind()
    ((before, after),) = statistics.items()
    for key, document in connection.execute(sa.select(demonstrations)).all():
        changed = {**_renamed(document, statistics), after: _renamed(document[before], counts)}
        this = demonstrations.c.id == key
        connection.execute(sa.update(demonstrations).where(this).values(document=changed))


def _renamed(document, names):
    return {names.get(key, key): value for key, value in document.items()}
