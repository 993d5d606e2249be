"""Tasks whose object lies where the hand grasps, anew in each demonstration."""

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("tasks") as tasks:
        tasks.add_column(sa.Column("object_at_grasp", sa.Boolean(), nullable=True))
    rows = sa.table("tasks", sa.column("object_at_grasp", sa.Boolean))
    op.get_bind().execute(sa.update(rows).values(object_at_grasp=False))
    with op.batch_alter_table("tasks") as tasks:
        tasks.alter_column("object_at_grasp", existing_type=sa.Boolean(), nullable=False)


def downgrade() -> None:
    with op.batch_alter_table("tasks") as tasks:
        tasks.drop_column("object_at_grasp")
