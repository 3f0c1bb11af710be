"""How often somebody may try a password: counted in Redis where the service has one, else in this process."""

from __future__ import annotations

import logging
from typing import cast

from limits import RateLimitItem, parse
from limits.errors import StorageError
from limits.storage import MemoryStorage, Storage, storage_from_string
from limits.strategies import MovingWindowRateLimiter

from store.errors import TooManyError
from store.settings import Settings

from .rates import seconds_to

ONE_ACCOUNT_ONE_ADDRESS = "5 per minute"
ONE_ADDRESS = "60 per 10 minutes"
ONE_ACCOUNT = "50 per hour"
"""Looser, since strangers can use it up. It does not count for browsers with which the owner has signed in before."""
ONE_KNOWN_BROWSER = ("5 per minute", "50 per hour")
"""Of one account from a browser that it knows, or from a session: counted apart from what strangers try."""
log = logging.getLogger(__name__)


class Attempts:
    """Every try counts when it begins, so that many at once count too; one that succeeds is forgiven.

    `known`: the number of a browser that this account knows (api/known_browsers.py), or of one's session.
    """

    def __init__(self, settings: Settings):
        self._own = MovingWindowRateLimiter(MemoryStorage())
        self._shared = self._own
        self._prefix = settings.queue_prefix
        if settings.broker_url.startswith("redis"):
            options = {"socket_connect_timeout": 1, "socket_timeout": 1}
            storage = storage_from_string(settings.broker_url, wrap_exceptions=True, **options)
            self._shared = MovingWindowRateLimiter(cast(Storage, storage))

    def begin(self, account: str, address: str, known: str | None = None) -> None:
        """Raises TooManyError."""
        self._count(self._items(account, address, known))

    def begin_from(self, address: str) -> None:
        """An attempt that names no account. Raises TooManyError."""
        self._count([(parse(ONE_ADDRESS), (self._prefix, "address", address))])

    def _count(self, items: list[tuple[RateLimitItem, tuple[str, ...]]]) -> None:
        for item, keys in items:
            if not self._hit(item, keys):
                wait = seconds_to(self._reset(item, keys))
                raise TooManyError(f"Too many attempts; try again in {wait} s.", wait)

    def forgive(self, account: str, address: str, known: str | None = None) -> None:
        item, keys = self._items(account, address, known)[0]
        for limiter in (self._own, self._shared):
            try:
                limiter.clear(item, *keys)
            except StorageError as error:
                log.warning("Attempts cannot be forgotten: %s", error)

    def _items(self, account: str, address: str, known: str | None) -> list[tuple[RateLimitItem, tuple[str, ...]]]:
        if known is not None:
            return [(parse(item), (self._prefix, "known", account, known)) for item in ONE_KNOWN_BROWSER]
        return [
            (parse(ONE_ACCOUNT_ONE_ADDRESS), (self._prefix, "pair", account, address)),
            (parse(ONE_ADDRESS), (self._prefix, "address", address)),
            (parse(ONE_ACCOUNT), (self._prefix, "account", account)),
        ]

    def _hit(self, item: RateLimitItem, keys: tuple[str, ...]) -> bool:
        try:
            return self._shared.hit(item, *keys)
        except StorageError as error:
            log.warning("Attempts are counted in this process only: %s", error)
            return self._own.hit(item, *keys)

    def _reset(self, item: RateLimitItem, keys: tuple[str, ...]) -> float:
        try:
            return self._shared.get_window_stats(item, *keys).reset_time
        except StorageError:
            return self._own.get_window_stats(item, *keys).reset_time
