"""What a repository or service refuses; the API turns each into an HTTP answer in one place."""

from __future__ import annotations

from solver.outcome import SlowdriftError


class NotFoundError(SlowdriftError):
    """There is no such row, or it is not the caller's."""

    def __init__(self, what: str, key: str):
        self.what, self.key = what, key
        super().__init__(f"There is no {what} {key[:100]!r}." if key else f"There is no such {what}, or no longer.")


class SignInError(SlowdriftError):
    """Nobody known asks, or the password is wrong."""


class ForbiddenError(SlowdriftError):
    """The caller is known, and may not do this."""


class TooManyError(SlowdriftError):
    """Too many attempts in a short time."""

    def __init__(self, message: str, retry_after: int):
        self.retry_after = retry_after
        super().__init__(message)


class QuotaError(SlowdriftError):
    """The team has as much as it may have."""


class ConflictError(SlowdriftError):
    """The row is in a state that does not allow this."""


class UnavailableError(SlowdriftError):
    """Something the answer needs is not there now; trying later may help."""


class TooSlowError(SlowdriftError):
    """The answer did not come in the time allowed."""


class LostLeaseError(SlowdriftError):
    """Another worker, or a final state, has taken the task over: nothing was written."""
