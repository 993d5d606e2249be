"""What people call a task, beside its name."""

import sqlalchemy as sa
from alembic import op

revision = "0019"
down_revision = "0018"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("tasks") as tasks:
        tasks.add_column(sa.Column("display_name", sa.Text(), nullable=True))
    rows = sa.table("tasks", sa.column("display_name", sa.Text))
    op.get_bind().execute(sa.update(rows).values(display_name=""))
    with op.batch_alter_table("tasks") as tasks:
        tasks.alter_column("display_name", existing_type=sa.Text(), nullable=False)


def downgrade() -> None:
    with op.batch_alter_table("tasks") as tasks:
        tasks.drop_column("display_name")
