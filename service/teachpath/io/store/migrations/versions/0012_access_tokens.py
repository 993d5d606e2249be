"""Tokens of programs, and who ordered a job."""

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "access_tokens",
        sa.Column("digest", sa.String(64), primary_key=True),
        sa.Column("name", sa.String(64), nullable=False),
        sa.Column("roles", sa.JSON(), nullable=False),
        sa.Column("created_ns", sa.BigInteger(), nullable=False),
        sa.Column("expires_ns", sa.BigInteger(), nullable=False),
        sa.Column("used_ns", sa.BigInteger(), nullable=False),
        sa.Column("revoked_ns", sa.BigInteger(), nullable=False),
    )
    op.create_index("ix_access_tokens_name", "access_tokens", ["name"])
    with op.batch_alter_table("jobs") as jobs:
        jobs.add_column(sa.Column("who", sa.String(64), nullable=True))
    rows = sa.table("jobs", sa.column("who", sa.String))
    op.get_bind().execute(sa.update(rows).values(who=""))
    with op.batch_alter_table("jobs") as jobs:
        jobs.alter_column("who", existing_type=sa.String(64), nullable=False)


def downgrade() -> None:
    with op.batch_alter_table("jobs") as jobs:
        jobs.drop_column("who")
    op.drop_index("ix_access_tokens_name", "access_tokens")
    op.drop_table("access_tokens")
