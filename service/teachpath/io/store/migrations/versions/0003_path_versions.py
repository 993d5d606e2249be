"""Path versions: who edited what, on which branch."""

from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

# What was learned before is the first version of the branch that it begins.
DEFAULTS: dict[str, tuple[Any, Any]] = {
    "branch": (sa.String(64), "main"),
    "name": (sa.Text, "learned"),
    "author": (sa.Text, ""),
    "note": (sa.Text, ""),
}


def upgrade() -> None:
    with op.batch_alter_table("paths") as table:
        table.add_column(sa.Column("parent", sa.Integer, nullable=True))
        for name, (kind, value) in DEFAULTS.items():
            table.add_column(sa.Column(name, kind, nullable=False, server_default=value))
    with op.batch_alter_table("paths") as table:
        for name in DEFAULTS:
            table.alter_column(name, server_default=None)


def downgrade() -> None:
    with op.batch_alter_table("paths") as table:
        for name in ("parent", *DEFAULTS):
            table.drop_column(name)
