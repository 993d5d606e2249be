"""People who sign in at a provider of OpenID Connect: which one it is, and who they are there."""

import sqlalchemy as sa
from alembic import op

revision = "0016"
down_revision = "0015"
branch_labels = None
depends_on = None

ADDED = ("issuer", "subject")


def upgrade() -> None:
    with op.batch_alter_table("people") as changed:
        for name in ADDED:
            changed.add_column(sa.Column(name, sa.Text(), nullable=True))
    people = sa.table("people", *(sa.column(name, sa.Text()) for name in ADDED))
    op.get_bind().execute(sa.update(people).values(dict.fromkeys(ADDED, "")))
    with op.batch_alter_table("people") as changed:
        for name in ADDED:
            changed.alter_column(name, existing_type=sa.Text(), nullable=False)


def downgrade() -> None:
    op.execute("DELETE FROM sessions WHERE person IN (SELECT name FROM people WHERE issuer <> '')")
    op.execute("DELETE FROM people WHERE issuer <> ''")  # nobody of them could sign in, and none has a password
    with op.batch_alter_table("people") as changed:
        for name in ADDED:
            changed.drop_column(name)
