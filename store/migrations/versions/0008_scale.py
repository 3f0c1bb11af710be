"""Indexes for a hundred thousand runs and more, and the values that tables show (store/figures.py).

Safe while the service runs: on PostgreSQL the indexes are made CONCURRENTLY, outside of a transaction, and the new
column has no default, so that no table is rewritten. One that was broken off can be run again.
"""

import logging

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"
branch_labels = None
depends_on = None

ACTIVE = sa.text("state IN ('queued', 'running', 'cancelling')")
TIMED = sa.text("state = 'succeeded' AND seconds IS NOT NULL")
INDEXES = (
    ("ix_runs_finished", "runs", ["finished_at"], None),
    ("ix_runs_data_set", "runs", ["data_set_id"], None),
    ("ix_runs_state", "runs", ["state"], None),
    ("ix_runs_starter", "runs", ["project_id", "created_by", "id"], None),
    ("ix_runs_active", "runs", ["project_id", "id"], ACTIVE),
    ("ix_runs_jobs", "runs", ["project_id", "id"], sa.text("kind = 'hydrodynamics'")),
    ("ix_tasks_timed", "tasks", ["queue", "id"], TIMED),
)

TRIGRAMS = {
    "ix_runs_name_trgm": "lower(name)",
    "ix_runs_case_name_trgm": "lower(case_name)",
    "ix_runs_tags_trgm": "(tags::text)",
}
"""Searched for a part of them; by the extension pg_trgm, which PostgreSQL's own packages hold."""
log = logging.getLogger("alembic.runtime.migration")


def upgrade() -> None:
    columns = {column["name"] for column in sa.inspect(op.get_bind()).get_columns("runs")}
    if "figures" not in columns:
        op.add_column("runs", sa.Column("figures", sa.Text(), nullable=True))
    if op.get_bind().dialect.name != "postgresql":
        for name, table, names, where in INDEXES:
            op.create_index(name, table, names, sqlite_where=where, if_not_exists=True)
        return
    with op.get_context().autocommit_block():
        for name, table, names, where in INDEXES:
            op.execute(f"DROP INDEX CONCURRENTLY IF EXISTS {name}")  # one that was broken off is there, and not valid
            op.create_index(name, table, names, postgresql_where=where, postgresql_concurrently=True)
        if _has_trigrams():
            for name, expression in TRIGRAMS.items():
                op.execute(f"DROP INDEX CONCURRENTLY IF EXISTS {name}")
                op.execute(f"CREATE INDEX CONCURRENTLY {name} ON runs USING gin ({expression} gin_trgm_ops)")


def _has_trigrams() -> bool:
    """Whether the extension is there, or could be made; without it, searching reads all rows."""
    try:
        op.execute("CREATE EXTENSION IF NOT EXISTS pg_trgm")
    except sa.exc.DBAPIError as error:
        log.warning("No index for searching parts of names, since pg_trgm cannot be had (%s)", error.orig)
        return False
    return True


def downgrade() -> None:
    for name in TRIGRAMS if op.get_bind().dialect.name == "postgresql" else ():
        op.drop_index(name, table_name="runs", if_exists=True)
    for name, of, _, _ in INDEXES:
        op.drop_index(name, table_name=of, if_exists=True)
    with op.batch_alter_table("runs") as table:
        table.drop_column("figures")
