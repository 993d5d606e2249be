"""Names of motion by the field's terms: the squared rates of a plan, and the activity of an execution's status."""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None

NAMES = {"plans": {"pace": "squared_rates"}, "executions": {"stretch": "activity"}}


def upgrade() -> None:
    _rewrite(NAMES)


def downgrade() -> None:
    _rewrite({table: {new: old for old, new in names.items()} for table, names in NAMES.items()})


def _rewrite(tables):
    connection = op.get_bind()
    for name, names in tables.items():
        table = sa.table(name, sa.column("id", sa.String), sa.column("document", sa.JSON))
        for key, document in connection.execute(sa.select(table.c.id, table.c.document)).all():
            changed = _renamed(document, names)
            connection.execute(sa.update(table).where(table.c.id == key).values(document=changed))


def _renamed(document, names):
    if isinstance(document, dict):
        return {names.get(key, key): _renamed(value, names) for key, value in document.items()}
    return document
