"""A time domain that was refused: what it computed, kept apart from results that stand."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .time import time_summary

if TYPE_CHECKING:
    from .time import TimeResult

NAME = "time_domain_doubtful"


def add_doubtful(summary: dict[str, Any], result: TimeResult | None) -> None:
    """Put what a refused time domain computed into the summary under a name of its own, and say so in the failure."""
    if result is None:
        return
    doubt = summary["failures"]["time_domain"]
    kept, seeds = result.head["kept"] * result.head["h"], len(result.seeds)
    summary[NAME] = {**time_summary(result), "converged": False, "doubt": doubt, "seeds": result.seeds}
    summary["failures"]["time_domain"] = (
        f"{doubt} What was computed ({seeds} seed{'s' if seeds > 1 else ''}, {kept:.4g} s after the build-up) is in the "
        f"summary under {NAME}; do not use it as a result."
    )
