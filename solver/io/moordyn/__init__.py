"""MoorDyn decks: read into a case, written from one (docs/moordyn.md)."""

from .read import Imported, read_deck
from .report import Report
from .write import Placed, Written, write_deck

__all__ = ["Imported", "Placed", "Report", "Written", "read_deck", "write_deck"]
