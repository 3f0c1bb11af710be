"""Studies, priorities, time at work, reproducibility and retention of runs, idempotency keys."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

SECONDS = sa.Float(precision=53)


def _run_columns() -> list[sa.Column]:
    return [
        sa.Column("name", sa.String(length=200), nullable=False, server_default=""),
        sa.Column("tags", sa.JSON(), nullable=False, server_default="[]"),
        sa.Column("pinned", sa.Boolean(), nullable=False, server_default=sa.false()),
        sa.Column("study_id", sa.String(length=32), nullable=True),
        sa.Column("study_index", sa.Integer(), nullable=True),
        sa.Column("overrides", sa.JSON(), nullable=True),
        sa.Column("data_hash", sa.String(length=64), nullable=True),
        sa.Column("identity", sa.String(length=64), nullable=True),
        sa.Column("rerun_of", sa.String(length=32), nullable=True),
        sa.Column("created_by", sa.String(length=32), nullable=True),
    ]


def _task_columns() -> list[sa.Column]:
    return [
        sa.Column("priority", sa.Integer(), nullable=False, server_default="20"),
        sa.Column("claimed_at", SECONDS, nullable=True),
        sa.Column("seconds", SECONDS, nullable=True),
    ]


def upgrade() -> None:
    op.create_table(
        "studies",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("project_id", sa.String(length=32), nullable=False),
        sa.Column("case_version_id", sa.String(length=32), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("analyses", sa.JSON(), nullable=False),
        sa.Column("axes", sa.JSON(), nullable=True),
        sa.Column("pointers", sa.JSON(), nullable=False),
        sa.Column("size", sa.Integer(), nullable=False),
        sa.Column("created_by", sa.String(length=32), nullable=True),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["case_version_id"], ["case_versions.id"], name=op.f("fk_studies_case_version_id")),
        sa.ForeignKeyConstraint(["project_id"], ["projects.id"], name=op.f("fk_studies_project_id")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_studies")),
    )
    op.create_table(
        "idempotency_keys",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("project_id", sa.String(length=32), nullable=False),
        sa.Column("key", sa.String(length=200), nullable=False),
        sa.Column("fingerprint", sa.String(length=64), nullable=False),
        sa.Column("resource_id", sa.String(length=32), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["project_id"], ["projects.id"], name=op.f("fk_idempotency_keys_project_id")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_idempotency_keys")),
        sa.UniqueConstraint("project_id", "key", name=op.f("uq_idempotency_keys_project_id_key")),
    )
    with op.batch_alter_table("runs") as table:
        for column in _run_columns():
            table.add_column(column)
        table.create_foreign_key("fk_runs_study_id", "studies", ["study_id"], ["id"])
        table.create_index("ix_runs_project_id", ["project_id", "id"])
        table.create_index("ix_runs_study", ["study_id", "study_index"])
        table.create_index("ix_runs_identity", ["project_id", "identity"])
    with op.batch_alter_table("tasks") as table:
        for column in _task_columns():
            table.add_column(column)
        table.create_index("ix_tasks_claim", ["queue", "state", "priority", "id"])


def downgrade() -> None:
    """Runs of studies lose what tells them from their base case, so they go; single runs stay."""
    op.execute("DELETE FROM channels WHERE run_id IN (SELECT id FROM runs WHERE study_id IS NOT NULL)")
    op.execute("DELETE FROM tasks WHERE run_id IN (SELECT id FROM runs WHERE study_id IS NOT NULL)")
    op.execute("DELETE FROM runs WHERE study_id IS NOT NULL")
    with op.batch_alter_table("tasks") as table:
        table.drop_index("ix_tasks_claim")
        for column in reversed(_task_columns()):
            table.drop_column(column.name)
    with op.batch_alter_table("runs") as table:
        for name in ("ix_runs_identity", "ix_runs_study", "ix_runs_project_id"):
            table.drop_index(name)
        table.drop_constraint("fk_runs_study_id", type_="foreignkey")
        for column in reversed(_run_columns()):
            table.drop_column(column.name)
    op.drop_table("idempotency_keys")
    op.drop_table("studies")
