"""The REST service: thin routes over services; documented in docs/rest.md."""
