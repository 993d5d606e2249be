"""Lists a page at a time: a summary beside what a run has learned, and indexes by the order of every list."""

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"
branch_labels = None
depends_on = None

ORDERS = {"runs": ("task", "created_ns"), "jobs": ("task", "created_ns"), "plans": ("path", "created_ns")}


def upgrade() -> None:
    with op.batch_alter_table("runs") as runs:
        runs.add_column(sa.Column("summary", sa.JSON(), nullable=True))
    _summarize()
    with op.batch_alter_table("runs") as runs:
        runs.alter_column("summary", existing_type=sa.JSON(), nullable=False)
    for table, (owner, created) in ORDERS.items():
        op.create_index(f"ix_{table}_{owner}_{created}", table, [owner, created, "id"])
    op.create_index("ix_executions_created_ns", "executions", ["created_ns", "id"])


def downgrade() -> None:
    op.drop_index("ix_executions_created_ns", "executions")
    for table, (owner, created) in ORDERS.items():
        op.drop_index(f"ix_{table}_{owner}_{created}", table)
    with op.batch_alter_table("runs") as runs:
        runs.drop_column("summary")


def _summarize():
    connection = op.get_bind()
    texts = [sa.column(name, sa.String) for name in ("id", "task")]
    documents = [sa.column(name, sa.JSON) for name in ("document", "summary")]
    table = sa.table("runs", *texts, sa.column("created_ns", sa.BigInteger), *documents)
    for key, task, created_ns in connection.execute(sa.select(table.c.id, table.c.task, table.c.created_ns)).all():
        learned = connection.execute(sa.select(table.c.document).where(table.c.id == key)).scalar_one()
        summary = {
            "id": key,
            "task": task,
            "created_ns": created_ns,
            "mode": learned["mode"],
            "demonstrations": len(learned["demonstrations"]),
            "paths": [path["id"] for path in learned["paths"]],
        }
        connection.execute(sa.update(table).where(table.c.id == key).values(summary=summary))
