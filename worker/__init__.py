"""Celery workers: claim a task's row, compute its chunk, store the result."""
