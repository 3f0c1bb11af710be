"""The database: models, migrations, repositories, array blobs. Shared by the API and the workers."""
