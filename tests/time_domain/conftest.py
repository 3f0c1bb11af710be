"""The synthetic box's data, as the frequency domain's tests have them."""

from tests.frequency_domain.conftest import source

__all__ = ["source"]
