"""Hydrodynamic data of a vessel: the one class, its readers and where files come from (no compiled code here)."""

from .hydrodynamics import HydrodynamicData
from .qtf import QTF
from .source import MAX_BYTES, DataSource, FileSource, read_bytes

__all__ = ["MAX_BYTES", "QTF", "DataSource", "FileSource", "HydrodynamicData", "read_bytes"]
