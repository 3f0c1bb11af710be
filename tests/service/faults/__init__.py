"""Faults as repeatable scripts: `python -m tests.service.faults --help` (docs/operations.md has the results)."""
