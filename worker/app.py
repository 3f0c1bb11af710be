"""The Celery app, configured from the settings. It delivers; what is true stands in the database."""

from __future__ import annotations

from typing import Any

from celery import Celery
from celery.signals import setup_logging

from store.broker import celery_config
from store.logs import configure
from store.settings import Settings

settings = Settings.from_env()

app = Celery("slowdrift", include=["worker.tasks"])
app.conf.update(celery_config(settings))
app.conf.update(
    worker_prefetch_multiplier=1,
    worker_disable_prefetch=settings.broker_url.startswith(("redis", "valkey")),
    worker_max_memory_per_child=settings.worker_memory_mb * 1024,
    worker_proc_alive_timeout=600.0,  # a child compiles kernels before it reports for work
    worker_enable_remote_control=False,
    worker_send_task_events=False,
    worker_cancel_long_running_tasks_on_connection_loss=False,
    worker_hijack_root_logger=False,
)


@setup_logging.connect
def _configure_logs(**_: Any) -> None:
    configure(settings.log_level, settings.log_json)
