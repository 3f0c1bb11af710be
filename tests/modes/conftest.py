"""The coupled box of the frequency domain's tests."""

from tests.frequency_domain.conftest import source

__all__ = ["source"]
