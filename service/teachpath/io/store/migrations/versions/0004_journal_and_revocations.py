"""The journal of who did what to the arm, revoked certificates, and executions without a plan."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

ID = sa.String(64)


def upgrade() -> None:
    with op.batch_alter_table("executions") as executions:
        executions.alter_column("plan", existing_type=ID, nullable=True)
    op.create_table(
        "revocations",
        sa.Column("plan", ID, sa.ForeignKey("plans.id"), primary_key=True),
        sa.Column("at_ns", sa.BigInteger, nullable=False),
        sa.Column("who", ID, nullable=False),
        sa.Column("reason", sa.Text, nullable=False),
    )
    op.create_table(
        "journal",
        sa.Column("number", sa.Integer, primary_key=True, autoincrement=True),
        sa.Column("at_ns", sa.BigInteger, nullable=False),
        sa.Column("who", ID, nullable=False),
        sa.Column("verb", sa.String(32), nullable=False),
        sa.Column("execution", ID, nullable=False, index=True),
        sa.Column("answer", sa.Text, nullable=False),
    )


def downgrade() -> None:
    op.drop_table("journal")
    op.drop_table("revocations")
    # Executions without a plan, those that mirrored a hand, have no place in the former form.
    op.execute("DELETE FROM executions WHERE plan IS NULL")
    with op.batch_alter_table("executions") as executions:
        executions.alter_column("plan", existing_type=ID, nullable=False)
