"""Coroutines in tests: run where no event loop runs, whatever the tests before have left in the main thread."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any, TypeVar

T = TypeVar("T")


def awaited(coroutine: Coroutine[Any, Any, T]) -> T:
    """The result of the coroutine, run to its end in a thread of its own.

    Playwright's synchronous driver keeps an event loop in the main thread for as long as a browser is open;
    `asyncio.run` refuses to start a second one there.
    """
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(asyncio.run, coroutine).result()
