"""WAMIT's numeric output files: read as one set, and written."""

from .read import KINDS, kind_of, lacking, manifest_hash, read_wamit
from .write import conventions_of, write_wamit

__all__ = ["KINDS", "conventions_of", "kind_of", "lacking", "manifest_hash", "read_wamit", "write_wamit"]
