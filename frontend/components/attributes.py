"""HTML attributes with a hyphen, which Python cannot write as keyword arguments."""

from __future__ import annotations

from typing import Any


def hyphened(**values: Any) -> dict[str, Any]:
    """``**hyphened(aria_label="Line")`` sets ``aria-label``."""
    return {name.replace("_", "-"): value for name, value in values.items()}
