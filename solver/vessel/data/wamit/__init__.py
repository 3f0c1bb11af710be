"""WAMIT's numeric output files: read as one set, and written."""

from .read import KINDS, kind_of, manifest_hash, read_wamit

__all__ = ["KINDS", "kind_of", "manifest_hash", "read_wamit"]
