"""A finished run as the panels see it: what it is, what it holds, and a way to fetch channels when one is drawn."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from frontend.client import Client
from frontend.errors import ApiError


@dataclass
class Results:
    """Everything is fetched when first asked for, and only once."""

    client: Client
    run_id: str
    options: dict[str, Any] = field(default_factory=dict)
    used: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def run(self) -> dict[str, Any]:
        found: dict[str, Any] = self.client.get(f"/runs/{self.run_id}")
        return found

    @cached_property
    def stored_case(self) -> dict[str, Any]:
        """The very case that the run computed (a study's run: with its changes) and its YAML; empty when there is none."""
        try:
            found: dict[str, Any] = self.client.get(f"/runs/{self.run_id}/case")
        except ApiError:
            return {}
        return found

    @property
    def case(self) -> dict[str, Any]:
        return self.stored_case.get("case") or {}

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Empty when the run left none."""
        try:
            found: dict[str, Any] = self.client.get(f"/runs/{self.run_id}/summary")
        except ApiError as error:
            if error.status in (404, 409):
                return {}
            raise
        return found

    @cached_property
    def listed(self) -> list[str]:
        """Names of all channels."""
        try:
            return [item["name"] for item in self.client.get(f"/runs/{self.run_id}/channels")["items"]]
        except ApiError as error:
            if error.status in (404, 409):
                return []
            raise

    @property
    def time_domain(self) -> str:
        """What a legend calls it."""
        count = (self.summary.get("time_domain") or {}).get("realisations")
        return f"time domain, {count} seed{'s' if count != 1 else ''}" if count else "time domain"

    @cached_property
    def names(self) -> frozenset[str]:
        return frozenset(self.listed)

    @cached_property
    def lines(self) -> list[str]:
        """Line names in the order of the result."""
        seen = (name.split("/")[2] for name in self.listed if name.split("/")[1:2] == ["line"])
        return list(dict.fromkeys(seen))

    def option(self, name: str, allowed: Iterable[str]) -> str | None:
        """The reader's choice if it is allowed, else the first that is; `used` remembers it."""
        choices = list(allowed)
        asked = self.options.get(name)
        self.used[name] = asked if asked in choices else next(iter(choices), None)
        found: str | None = self.used[name]
        return found

    def channels(self, names: Iterable[str], **view: Any) -> dict[str, dict[str, Any]]:
        """Those of the named channels that the run has; `view` picks, slices and decimates on the server."""
        return self.client.channels(self.run_id, [name for name in names if name in self.names], **view)

    def per_line(self, pattern: str) -> dict[str, dict[str, Any]]:
        """The channel ``pattern`` (with ``{line}``) of every line that has it, by line name."""
        wanted = {pattern.format(line=line): line for line in self.lines}
        return {wanted[name]: channel for name, channel in self.channels(wanted).items()}
