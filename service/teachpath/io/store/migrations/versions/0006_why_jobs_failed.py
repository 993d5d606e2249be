"""Jobs that failed keep where the path fails, or which demonstration is to blame."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    with op.batch_alter_table("jobs") as jobs:
        jobs.add_column(sa.Column("failure", sa.JSON(none_as_null=True), nullable=True))
        jobs.add_column(sa.Column("demonstration", sa.String(64), nullable=True))
    op.execute("UPDATE jobs SET demonstration = ''")
    with op.batch_alter_table("jobs") as jobs:
        jobs.alter_column("demonstration", existing_type=sa.String(64), nullable=False)


def downgrade() -> None:
    with op.batch_alter_table("jobs") as jobs:
        jobs.drop_column("demonstration")
        jobs.drop_column("failure")
