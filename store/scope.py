"""Whose rows a request may see: every repository takes a scope, and every query of a user's rows passes it."""

from __future__ import annotations

from dataclasses import dataclass

from .models import DEFAULT_PROJECT, DEFAULT_TEAM


@dataclass(frozen=True)
class Scope:
    """The team and project in which the caller works; the default ones where nobody signs in."""

    team_id: str = DEFAULT_TEAM
    project_id: str = DEFAULT_PROJECT
    user_id: str | None = None
    """Who asks; nobody in particular where nobody signs in, or behind a share link."""
    run_ids: tuple[str, ...] | None = None
    """The only runs to be seen, with their cases, behind a share link; None: all of the project."""
