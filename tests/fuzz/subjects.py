"""What is fuzzed: for each reader its files, how they are read, and the numbers that come out as plain arrays."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from solver.bem.panels import Panels
from solver.bem.read import read_mesh
from solver.io.moordyn import read_deck
from solver.io.moordyn.deck import parse_deck
from solver.vessel.data import HydrodynamicData, bundle, read_files
from solver.vessel.data.layout import dump_netcdf
from tests.bem import shapes
from tests.io import decks
from tests.vessel import synthetic, wamit_sets

Array = np.ndarray
Numbers = dict[str, Array]


@dataclass(frozen=True)
class Subject:
    """files : by name, of which one is damaged at a time; read : of all files, numbers by name, or raises.

    own_corners : each panel of a mesh has corners of its own, so that a damaged one may collapse it.
    """

    files: dict[str, bytes]
    read: Callable[[dict[str, bytes]], Numbers]
    own_corners: bool = False


def subject(name: str) -> Subject:
    """The subject of a reader, made anew in every process."""
    return SUBJECTS[name]()


def _numbers_of_data(data: HydrodynamicData) -> Numbers:
    found: Numbers = {}
    for item in fields(data):
        value: Any = getattr(data, item.name)
        if isinstance(value, np.ndarray | float):
            found[item.name] = np.asarray(value)
    if data.qtf is not None:
        found |= {"qtf omega": data.qtf.omega, "qtf headings": data.qtf.headings, "qtf": data.qtf.values}
        found |= {f"qtf {pair}": table for pair, table in data.qtf.cross.items()}
    return found


def _data(files: dict[str, bytes]) -> Numbers:
    return _numbers_of_data(read_files(files, wamit_sets.OPTIONS))


def _synthetic(engine: str) -> bytes:
    made = synthetic.dataset(omega=[0.3, 0.5, 0.9, 1.4], headings=[0.0, 0.4, 1.0])
    with tempfile.TemporaryDirectory() as folder:
        return synthetic.to_bytes(made, Path(folder), engine)


def _copied(payload: bytes, layout: str) -> bytes:
    """The same content in HDF5's oldest layout, without any checksum, or in its latest, as NetCDF-C writes it."""
    import h5py

    target = io.BytesIO()
    with h5py.File(io.BytesIO(payload), "r") as source, h5py.File(target, "w", libver=(layout, "v110")) as copy:
        for name in source:
            item = source[name]
            made = copy.create_dataset(name, data=item[()], dtype=item.dtype)
            if item.is_scale:
                made.make_scale(name)
        for name in source:
            for axis, scales in enumerate(source[name].dims):
                for scale in list(scales.values())[:1]:
                    copy[name].dims[axis].attach_scale(copy[str(scale.name).split("/")[-1]])
    return target.getvalue()


def _mesh(writer: Callable[[Panels], bytes], own_corners: bool = False) -> Callable[[], Subject]:
    def read(files: dict[str, bytes]) -> Numbers:
        return {"panels": read_mesh(files["hull.dat"], "hull.dat")[0].corners}

    return lambda: Subject({"hull.dat": writer(shapes.box(size=1.0))}, read, own_corners)


def _deck(text: str) -> Callable[[], Subject]:
    def read(files: dict[str, bytes]) -> Numbers:
        """Rows of the tables and options as text: a damaged row is one difference, whatever follows from it."""
        found = read_deck(files["deck.dat"], decks.VESSEL)
        assert found.case is not None
        deck = parse_deck(files["deck.dat"])
        rows = [f"{name} {' '.join(words)}" for name, table in deck.raw.items() for _, words in table]
        return {"rows": np.array(sorted(row for row in rows if not row.startswith("outputs")), dtype=object)}

    return lambda: Subject({"deck.dat": text.encode()}, read)


SUBJECTS: dict[str, Callable[[], Subject]] = {
    "hdf5": lambda: Subject({"a.nc": _synthetic("h5netcdf")}, _data),
    "hdf5-old": lambda: Subject({"a.nc": _copied(_synthetic("h5netcdf"), "earliest")}, _data),
    "hdf5-new": lambda: Subject({"a.nc": _copied(_synthetic("h5netcdf"), "v110")}, _data),
    "netcdf3": lambda: Subject({"a.nc": _synthetic("scipy")}, _data),
    "netcdf3-own": lambda: Subject({"a.nc": dump_netcdf(wamit_sets.whole())}, _data),
    "wamit": lambda: Subject(wamit_sets.files(), _data),
    "archive": lambda: Subject({"a.zip": bundle.pack(wamit_sets.files(), wamit_sets.OPTIONS)}, _data),
    "gdf": _mesh(shapes.as_gdf, own_corners=True),
    "nemoh": _mesh(shapes.as_nemoh),
    "stl": _mesh(shapes.as_stl, own_corners=True),
    "stl-text": _mesh(shapes.as_ascii_stl, own_corners=True),
    "msh2": _mesh(shapes.as_msh2),
    "msh4": _mesh(shapes.as_msh4),
    "pnl": _mesh(shapes.as_pnl),
    "deck": _deck(decks.DECK),
    "deck-v1": _deck(decks.V1),
}
