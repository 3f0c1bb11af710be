"""The turn of a task among those of its priority: shares between teams and users (store/repositories/turns.py)."""

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.drop_index("ix_tasks_claim", table_name="tasks")
    op.add_column("tasks", sa.Column("turn", sa.Float(precision=53), nullable=False, server_default="0"))
    op.create_index("ix_tasks_claim", "tasks", ["queue", "state", "priority", "turn", "id"])


def downgrade() -> None:
    op.drop_index("ix_tasks_claim", table_name="tasks")
    with op.batch_alter_table("tasks") as table:
        table.drop_column("turn")
    op.create_index("ix_tasks_claim", "tasks", ["queue", "state", "priority", "id"])
