"""Several stations and services on one database: whose a row is, who does a job, and which services run."""

import sqlalchemy as sa
from alembic import op

revision = "0015"
down_revision = "0014"
branch_labels = None
depends_on = None

ADDED: dict[str, tuple[str, ...]] = {
    "demonstrations": ("station",),
    "executions": ("station",),
    "jobs": ("station", "service"),
}


def upgrade() -> None:
    op.create_table(
        "services",
        sa.Column("id", sa.String(64), primary_key=True),
        sa.Column("station", sa.String(64), nullable=False),
        sa.Column("role", sa.String(16), nullable=False),
        sa.Column("place", sa.Text(), nullable=False),
        sa.Column("alive_ns", sa.BigInteger(), nullable=False),
    )
    for table, columns in ADDED.items():
        _add(table, {name: (sa.String(64), "") for name in columns})
    _add("jobs", {"cancel": (sa.Boolean(), False)})


def downgrade() -> None:
    for table, columns in ADDED.items():
        with op.batch_alter_table(table) as changed:
            for name in (*columns, *(["cancel"] if table == "jobs" else [])):
                changed.drop_column(name)
    op.drop_table("services")


def _add(table: str, columns: dict) -> None:
    with op.batch_alter_table(table) as changed:
        for name, (kind, _) in columns.items():
            changed.add_column(sa.Column(name, kind, nullable=True))
    rows = sa.table(table, *(sa.column(name, kind) for name, (kind, _) in columns.items()))
    op.get_bind().execute(sa.update(rows).values({name: value for name, (_, value) in columns.items()}))
    with op.batch_alter_table(table) as changed:
        for name, (kind, _) in columns.items():
            changed.alter_column(name, existing_type=kind, nullable=False)
