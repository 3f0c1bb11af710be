"""The columns of a deck's tables: their names in headers, and the orders in which MoorDyn reads them.

MoorDyn reads columns by their place, not by their names. A header that names columns in another order, or a column that
MoorDyn does not have, is refused; a header without any known name is taken by place and reported.
"""

from __future__ import annotations

from dataclasses import dataclass

NAMES = {
    "types": {
        "name": ("name", "linetype", "typename", "type"), "diameter": ("diam", "diameter", "d"),
        "mass": ("mass/m", "massden", "massdeninair", "mass"), "EA": ("ea",),
        "BA": ("ba/-zeta", "ba", "ba/zeta", "cintdamp"), "EI": ("ei",),
        "Cdn": ("cd", "cdn"), "Can": ("ca", "can"), "Cdt": ("cdax", "cdt"), "Cat": ("caax", "cat"), "Cl": ("cl",),
        "dF": ("df",), "cF": ("cf",),
    },
    "points": {
        "id": ("id", "node", "num", "point", "connection"), "kind": ("type", "attachment", "attach"), "x": ("x",), "y": ("y",),
        "z": ("z",), "mass": ("m", "mass"), "volume": ("v", "volume", "vol"), "FX": ("fx",), "FY": ("fy",), "FZ": ("fz",),
        "CdA": ("cda", "cda*"), "Ca": ("ca", "ca*"),
    },
    "lines": {
        "id": ("id", "line", "num"), "type": ("linetype", "type"), "a": ("attacha", "nodeanch", "nodea", "anchor"),
        "b": ("attachb", "nodefair", "nodeb", "fairlead"), "length": ("unstrlen", "length"),
        "segments": ("numsegs", "numseg", "segs"), "outputs": ("outputs", "lineoutputs", "flags/outputs", "flags"),
    },
    "bodies": {
        "id": ("id", "body"), "kind": ("attachment", "type"), "x": ("x0",), "y": ("y0",), "z": ("z0",), "roll": ("r0",),
        "pitch": ("p0",), "yaw": ("y0",), "mass": ("mass", "m"), "cg": ("cg*", "cg"), "inertia": ("i*", "i"),
        "volume": ("volume", "v"), "CdA": ("cda*", "cda"), "Ca": ("ca*", "ca"),
    },
}  # fmt: skip
ORDERS = {  # (version, columns in the order MoorDyn reads them, how many may be missing at the end)
    "types": (
        ("v2", "name diameter mass EA BA EI Cdn Can Cdt Cat Cl dF cF", 3),
        ("v1", "name diameter mass EA BA Can Cat Cdn Cdt", 0),
    ),
    "points": (
        ("v2", "id kind x y z mass volume CdA Ca", 0),
        ("v1", "id kind x y z mass volume FX FY FZ CdA Ca", 0),
    ),
    "lines": (
        ("v2", "id type a b length segments outputs", 1),
        ("v1", "id type length segments a b outputs", 1),
    ),
    "bodies": (("v2", "id kind x y z roll pitch yaw mass cg inertia volume CdA Ca", 0),),
}


@dataclass(frozen=True)
class Order:
    """The columns of a table. optional : how many may be missing at the end; by_place : the header named none of them."""

    version: str
    columns: tuple[str, ...]
    optional: int
    by_place: bool = False

    def takes(self, width: int) -> bool:
        return len(self.columns) - self.optional <= width <= len(self.columns)


def order_of(section: str, header: list[str], width: int) -> Order | str:
    """The order of a table by its header, else by the width of its first row; a sentence when there is none."""
    named = [[name for name, words in NAMES[section].items() if word.lower() in words] for word in header]
    orders = [Order(version, tuple(columns.split()), optional) for version, columns, optional in ORDERS[section]]
    if not any(named):
        found = next((order for order in orders if order.takes(width)), None)
        if found is None:
            return f"{width} columns fit no table of MoorDyn's"
        return Order(found.version, found.columns, found.optional, by_place=True)
    expected = " or ".join(
        f"{order.version}: {' '.join(NAMES[section][column][0] for column in order.columns)}" for order in orders
    )
    unknown = [word for word, names in zip(header, named, strict=True) if not names]
    if unknown:
        return (
            f"the column {unknown[0][:40]!r} is not one of MoorDyn's, which reads by place, not by name; put the values "
            f"in its order and write its names ({expected})"
        )
    for order in orders:
        here = zip(order.columns, named, strict=False)
        if order.takes(len(header)) and all(column in names for column, names in here):
            return order
    return f"the columns are not in an order MoorDyn reads; it reads by place, not by name ({expected})"
