"""Alembic's entry: one connection of the given engine, SQLite tables altered by copy."""

from alembic import context

from store import hydrodynamics, people  # noqa: F401  (their tables belong to the metadata)
from store.models import Base


def compared(_object, name, kind, _reflected, _other) -> bool:  # type: ignore[no-untyped-def]
    """Indexes over trigrams are PostgreSQL's only, and only where it has the extension: no model holds them."""
    return kind != "index" or not str(name).endswith("_trgm")


engine = context.config.attributes["engine"]
with engine.connect() as connection:
    sqlite = engine.dialect.name == "sqlite"
    raw = connection.connection.dbapi_connection
    if sqlite:  # a table altered by copy is dropped: with foreign keys on, what refers to it would be deleted with it
        raw.execute("PRAGMA foreign_keys=OFF")
    try:
        context.configure(
            connection=connection,
            target_metadata=Base.metadata,
            render_as_batch=sqlite,
            compare_type=True,
            include_object=compared,
        )
        with context.begin_transaction():
            context.run_migrations()
        if sqlite and (broken := connection.exec_driver_sql("PRAGMA foreign_key_check").all()):
            raise RuntimeError(f"the migration leaves references to nothing: {broken[:3]}")
        connection.commit()
    finally:
        if sqlite:
            connection.rollback()
            raw.execute("PRAGMA foreign_keys=ON")
