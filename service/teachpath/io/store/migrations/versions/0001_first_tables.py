"""First tables."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None

ID = sa.String(64)


def upgrade() -> None:
    op.create_table(
        "tasks",
        sa.Column("name", ID, primary_key=True),
        sa.Column("scene", ID, nullable=False),
        sa.Column("calibration", ID, nullable=False),
        sa.Column("created_ns", sa.BigInteger, nullable=False),
    )
    op.create_table(
        "demonstrations",
        sa.Column("id", ID, primary_key=True),
        sa.Column("task", ID, sa.ForeignKey("tasks.name"), nullable=False, index=True),
        sa.Column("number", sa.Integer, nullable=False),
        sa.Column("created_ns", sa.BigInteger, nullable=False),
        sa.Column("verdict", sa.String(16), nullable=False),
        sa.Column("document", sa.JSON, nullable=False),
        sa.UniqueConstraint("task", "number"),
    )
    op.create_table(
        "runs",
        sa.Column("id", ID, primary_key=True),
        sa.Column("task", ID, sa.ForeignKey("tasks.name"), nullable=False, index=True),
        sa.Column("created_ns", sa.BigInteger, nullable=False),
        sa.Column("document", sa.JSON, nullable=False),
    )
    op.create_table(
        "paths",
        sa.Column("id", ID, primary_key=True),
        sa.Column("version", sa.Integer, primary_key=True),
        sa.Column("run", ID, sa.ForeignKey("runs.id"), nullable=False, index=True),
        sa.Column("created_ns", sa.BigInteger, nullable=False),
        sa.Column("document", sa.JSON, nullable=False),
    )
    op.create_table(
        "plans",
        sa.Column("id", ID, primary_key=True),
        sa.Column("path", ID, nullable=False, index=True),
        sa.Column("created_ns", sa.BigInteger, nullable=False),
        sa.Column("document", sa.JSON, nullable=False),
    )
    op.create_table(
        "jobs",
        sa.Column("id", ID, primary_key=True),
        sa.Column("task", ID, nullable=False, index=True),
        sa.Column("kind", sa.String(16), nullable=False),
        sa.Column("state", sa.String(16), nullable=False, index=True),
        sa.Column("request", sa.JSON, nullable=False),
        sa.Column("fraction", sa.Float, nullable=False),
        sa.Column("message", sa.Text, nullable=False),
        sa.Column("outcome", ID, nullable=False),
        sa.Column("attempt", sa.Integer, nullable=False),
        sa.Column("created_ns", sa.BigInteger, nullable=False),
        sa.Column("finished_ns", sa.BigInteger, nullable=False),
    )
    op.create_table(
        "executions",
        sa.Column("id", ID, primary_key=True),
        sa.Column("plan", ID, sa.ForeignKey("plans.id"), nullable=False, index=True),
        sa.Column("created_ns", sa.BigInteger, nullable=False),
        sa.Column("document", sa.JSON, nullable=False),
    )


def downgrade() -> None:
    for table in ("executions", "jobs", "plans", "paths", "runs", "demonstrations", "tasks"):
        op.drop_table(table)
