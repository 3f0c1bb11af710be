"""Hydrodynamic jobs: runs without a case, uploaded meshes, and the data sets that came of them."""

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None

CASE_VERSION = sa.String(length=32)


def upgrade() -> None:
    op.create_table(
        "meshes",
        sa.Column("id", sa.String(length=32), nullable=False),
        sa.Column("project_id", sa.String(length=32), nullable=False),
        sa.Column("name", sa.String(length=200), nullable=False),
        sa.Column("content_hash", sa.String(length=64), nullable=False),
        sa.Column("size", sa.Integer(), nullable=False),
        sa.Column("summary", sa.JSON(), nullable=False),
        sa.Column("payload", sa.LargeBinary(), nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.ForeignKeyConstraint(["project_id"], ["projects.id"], name=op.f("fk_meshes_project_id")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_meshes")),
        sa.UniqueConstraint("project_id", "content_hash", name=op.f("uq_meshes_project_id_content_hash")),
    )
    with op.batch_alter_table("runs") as table:
        table.add_column(sa.Column("kind", sa.String(length=20), nullable=False, server_default="case"))
        table.alter_column("case_version_id", existing_type=CASE_VERSION, nullable=True)
    op.create_table(
        "hydrodynamic_jobs",
        sa.Column("run_id", sa.String(length=32), nullable=False),
        sa.Column("spec", sa.JSON(), nullable=False),
        sa.Column("estimate", sa.JSON(), nullable=False),
        sa.Column("mesh_id", sa.String(length=32), nullable=True),
        sa.Column("data_set_id", sa.String(length=32), nullable=True),
        sa.ForeignKeyConstraint(
            ["data_set_id"], ["data_sets.id"], name=op.f("fk_hydrodynamic_jobs_data_set_id"), ondelete="SET NULL"
        ),
        sa.ForeignKeyConstraint(["mesh_id"], ["meshes.id"], name=op.f("fk_hydrodynamic_jobs_mesh_id")),
        sa.ForeignKeyConstraint(["run_id"], ["runs.id"], name=op.f("fk_hydrodynamic_jobs_run_id"), ondelete="CASCADE"),
        sa.PrimaryKeyConstraint("run_id", name=op.f("pk_hydrodynamic_jobs")),
    )


def downgrade() -> None:
    """Hydrodynamic jobs go, since before this a run had a case; the data sets they made stay."""
    op.drop_table("hydrodynamic_jobs")
    for name in ("channels", "tasks"):
        op.execute(f"DELETE FROM {name} WHERE run_id IN (SELECT id FROM runs WHERE kind <> 'case')")
    op.execute("DELETE FROM runs WHERE kind <> 'case'")
    with op.batch_alter_table("runs") as table:
        table.alter_column("case_version_id", existing_type=CASE_VERSION, nullable=False)
        table.drop_column("kind")
    op.drop_table("meshes")
