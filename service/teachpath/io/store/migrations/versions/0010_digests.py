"""What a demonstration's recording is known by; rows of before it know none until the doctor has read their files."""

import sqlalchemy as sa
from alembic import op

revision = "0010"
down_revision = "0009"
branch_labels = None
depends_on = None

ROWS = sa.table("demonstrations", sa.column("id", sa.String), sa.column("document", sa.JSON))


def upgrade() -> None:
    _rewrite(lambda document: {**document, "digest": document.get("digest")})


def downgrade() -> None:
    _rewrite(lambda document: {name: value for name, value in document.items() if name != "digest"})


def _rewrite(changed):
    connection = op.get_bind()
    for key, document in connection.execute(sa.select(ROWS.c.id, ROWS.c.document)).all():
        connection.execute(sa.update(ROWS).where(ROWS.c.id == key).values(document=changed(document)))
