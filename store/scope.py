"""Whose rows a request may see: every repository takes a scope, and every query of a user's rows passes it."""

from __future__ import annotations

from dataclasses import dataclass

from .models import DEFAULT_PROJECT, DEFAULT_TEAM


@dataclass(frozen=True)
class Scope:
    """The team and project of the caller. Until there are accounts, the default ones."""

    team_id: str = DEFAULT_TEAM
    project_id: str = DEFAULT_PROJECT
