"""The scenes, each solved once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import pytest

from tests.frequency_domain.conftest import source
from tests.results.values.scenes import Linear, Timed, calm, regular, shaken, shaken_in_time, storm, storm_in_time
from tests.systems import Source

__all__ = ["source"]


class Lazy(Mapping[str, Any]):
    """Scenes by name, each solved when it is first wanted."""

    def __init__(self, **makers: Callable[[], Any]) -> None:
        self._makers = makers
        self._made: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._made:
            self._made[name] = self._makers[name]()
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._makers)

    def __len__(self) -> int:
        return len(self._makers)


@pytest.fixture(scope="session")
def linear(source: Source) -> Mapping[str, Linear]:
    return Lazy(
        storm=lambda: Linear.of(storm(), source), calm=lambda: Linear.of(calm(), source),
        regular=lambda: Linear.of(regular(), source), shaken=lambda: Linear.of(shaken(), None),
    )  # fmt: skip


@pytest.fixture(scope="session")
def timed_scenes(source: Source) -> Mapping[str, Timed]:
    return Lazy(
        storm=lambda: Timed.of(storm_in_time(), source, [(4, 6), (6, 7)]),
        shaken=lambda: Timed.of(shaken_in_time(), None, [(1, 2)]),
    )
