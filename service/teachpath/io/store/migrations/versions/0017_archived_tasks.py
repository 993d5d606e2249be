"""Tasks that were deleted: they are kept, and can be brought back."""

import sqlalchemy as sa
from alembic import op

revision = "0017"
down_revision = "0016"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("tasks") as tasks:
        tasks.add_column(sa.Column("archived_ns", sa.BigInteger(), nullable=True))
    rows = sa.table("tasks", sa.column("archived_ns", sa.BigInteger))
    op.get_bind().execute(sa.update(rows).values(archived_ns=0))
    with op.batch_alter_table("tasks") as tasks:
        tasks.alter_column("archived_ns", existing_type=sa.BigInteger(), nullable=False)


def downgrade() -> None:
    with op.batch_alter_table("tasks") as tasks:
        tasks.drop_column("archived_ns")
