"""The sign-in page says why a provider's word did not do."""

from __future__ import annotations

from typing import get_args

import pytest

from api.oidc_provider import Reason
from frontend.pages.sign_in import OIDC, layout


@pytest.mark.parametrize("reason", [*get_args(Reason), "many"])
def test_every_reason_has_its_words(reason: str) -> None:
    assert OIDC[reason] in str(layout(oidc=reason))


def test_other_words_are_not_shown() -> None:
    """The address is anybody's: it must not put words into the page."""
    assert "call 555" not in str(layout(oidc="call 555"))
    assert set(OIDC) == {*get_args(Reason), "many"}
