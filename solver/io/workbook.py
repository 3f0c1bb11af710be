"""Statistics tables as a workbook (.xlsx) for spreadsheets: a sheet for each table."""

from __future__ import annotations

from typing import IO, Any

from ..case import Case
from .statistics import Cell, Summary, Table, statistics_tables

OPTIONS = {"in_memory": True, "strings_to_formulas": False, "strings_to_urls": False, "strings_to_numbers": False}
WIDEST = 80  # characters of a column
FIXED, SMALL = "0.000", "0.00E+00"


def write_workbook(target: IO[bytes], summary: Summary, case: Case) -> None:
    """Write the tables of `statistics_tables` into an open binary file."""
    from xlsxwriter import Workbook

    with Workbook(target, OPTIONS) as book:
        book.set_properties({"title": case.name, "comments": "Slowdrift"})
        formats = {
            "header": book.add_format({"bold": True, "text_wrap": True, "valign": "top", "bottom": 1}),
            FIXED: book.add_format({"num_format": FIXED}),
            SMALL: book.add_format({"num_format": SMALL}),
        }
        for table in statistics_tables(summary, case):
            _sheet(book.add_worksheet(table.title), table, formats)


def _sheet(sheet: Any, table: Table, formats: dict[str, Any]) -> None:
    for column, header in enumerate(table.headers):
        cells = [row[column] for row in table.rows]
        longest = max((len(cell) for cell in cells if isinstance(cell, str)), default=0)
        sheet.set_column(column, column, min(max(14, longest + 1), WIDEST))
        sheet.write_string(0, column, header, formats["header"])
        for row, cell in enumerate(cells):
            _cell(sheet, row + 1, column, cell, formats)
    sheet.freeze_panes(1, 1)


def _cell(sheet: Any, row: int, column: int, cell: Cell, formats: dict[str, Any]) -> None:
    if cell is None or cell == "":
        return
    if isinstance(cell, str):
        sheet.write_string(row, column, cell)
    elif isinstance(cell, int):
        sheet.write_number(row, column, cell)
    else:
        sheet.write_number(row, column, cell, formats[SMALL if 0 < abs(cell) < 0.01 else FIXED])
