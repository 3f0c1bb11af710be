"""Hydrodynamic data of a vessel: the one class, its readers and where files come from (no compiled code here)."""

from .hydrodynamics import HydrodynamicData
from .qtf import QTF
from .source import MAX_BYTES, DataSource, FileSource, open_for, read_bytes, read_files, unpacked

__all__ = [
    "MAX_BYTES",
    "QTF",
    "DataSource",
    "FileSource",
    "HydrodynamicData",
    "open_for",
    "read_bytes",
    "read_files",
    "unpacked",
]
