"""All queries. A repository gets a session and a scope, never commits, and gives rows or plain values."""

from .cases import CaseRepository
from .channels import ChannelRepository
from .data_sets import DataSetRepository
from .idempotency import IdempotencyRepository
from .previews import PreviewRepository
from .queues import QueueRepository
from .recovery import RecoveryRepository
from .runs import RunRepository
from .studies import StudyRepository
from .tasks import TaskRepository

__all__ = [
    "CaseRepository",
    "ChannelRepository",
    "DataSetRepository",
    "IdempotencyRepository",
    "PreviewRepository",
    "QueueRepository",
    "RecoveryRepository",
    "RunRepository",
    "StudyRepository",
    "TaskRepository",
]
