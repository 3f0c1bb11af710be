"""Files of anybody: cut, spoilt and invented, they are refused with a sentence or read, and nothing else happens."""

import contextlib
import io
import os
import resource
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.outcome import DataError
from solver.vessel.data import bundle, read_files
from solver.vessel.data.wamit import read_wamit
from solver.vessel.data.wamit.text import read_table

from . import wamit_sets as sets

LONGER = int(os.environ.get("SLOWDRIFT_FUZZ", "1"))  # times as many examples, for a long run
PARTS = sets.files()
WORDS = st.one_of(
    st.floats().map(repr),
    st.integers(-9, 9).map(str),
    st.sampled_from(["1.0-100", "1d5", "****", "NaN", "-", "1e999", "é", "\0"]),
)


def attempt(parts):
    """The data or the sentence; any other exception fails the test."""
    try:
        data = read_wamit(parts, sets.OPTIONS)
    except DataError as error:
        text = str(error)
        assert "\n" not in text
        assert len(text) < 600
        return text
    assert np.isfinite(data.added_mass).all()
    assert np.isfinite(data.excitation).all()
    return data


@pytest.mark.parametrize("name", sorted(PARTS))
def test_a_file_that_is_cut_is_refused(name):
    """At every row's end and in the middle of rows: a shorter file never passes for the whole."""
    payload = PARTS[name]
    ends = [k for k, byte in enumerate(payload) if byte == 10]
    places = {
        *ends[:-1][:: max(len(ends) // 60, 1)],
        *(end - 4 for end in ends[:: max(len(ends) // 60, 1)]),
        *ends[-8:-1],
    }
    for place in sorted(places):
        found = attempt(PARTS | {name: payload[: place + 1]})
        if name == "t.hst" and not isinstance(found, str):  # entries that are left out are zero, and said
            assert "of 36 entries" in found.warnings[0], place
        else:
            assert isinstance(found, str), (name, place)
            assert name in found


@settings(max_examples=120 * LONGER, deadline=None)
@given(st.sampled_from(sorted(PARTS)), st.data())
def test_spoilt_bytes(name, draw):
    spoilt = bytearray(PARTS[name])
    for _ in range(draw.draw(st.integers(1, 6))):
        spoilt[draw.draw(st.integers(0, len(spoilt) - 1))] = draw.draw(st.integers(0, 255))
    attempt(PARTS | {name: bytes(spoilt)})


@settings(max_examples=120 * LONGER, deadline=None)
@given(st.sampled_from(sorted(PARTS)), st.data())
def test_spoilt_words_and_rows(name, draw):
    rows = PARTS[name].decode().splitlines()
    k = draw.draw(st.integers(0, len(rows) - 2))
    kind = draw.draw(st.sampled_from(["word", "drop", "twice", "swap", "join"]))
    if kind == "word":
        words = rows[k].split()
        words[draw.draw(st.integers(0, len(words) - 1))] = draw.draw(WORDS)
        rows[k] = " ".join(words)
    elif kind == "drop":
        rows.pop(k)
    elif kind == "twice":
        rows.insert(k, rows[k])
    elif kind == "swap":
        rows[0], rows[k] = rows[k], rows[0]
    else:
        rows[k : k + 2] = [" ".join(rows[k : k + 2])]
    found = attempt(PARTS | {name: "\n".join(rows).encode()})
    if kind in ("drop", "join") and not name.endswith((".hst", ".1")):
        assert isinstance(found, str)
    if kind == "swap":
        assert not isinstance(found, str)


@settings(max_examples=80 * LONGER, deadline=None)
@given(
    st.lists(st.lists(WORDS, max_size=10).map(" ".join), max_size=12),
    st.sampled_from([".1", ".3", ".8", ".12d", ".hst"]),
)
def test_invented_files(rows, kind):
    attempt(PARTS | {f"t{kind}": "\n".join(rows).encode()})


@settings(max_examples=60 * LONGER, deadline=None)
@given(st.binary(max_size=300))
def test_invented_bytes_of_any_kind(payload):
    for name in ("a.zip", "a.nc", "a.1"):
        for head in (b"", b"PK\x03\x04", b"CDF\x01", b"\x89HDF\r\n\x1a\n"):
            with pytest.raises(DataError):
                read_files({name: head + payload}, sets.OPTIONS)


@settings(max_examples=40 * LONGER, deadline=None)
@given(st.data())
def test_spoilt_archives(draw):
    packed = bytearray(bundle.pack(PARTS, sets.OPTIONS))
    for _ in range(draw.draw(st.integers(1, 4))):
        packed[draw.draw(st.integers(0, len(packed) - 1))] ^= draw.draw(st.integers(1, 255))
    with contextlib.suppress(DataError):
        read_files({"a.zip": bytes(packed)})


# --- limits


def bomb(size, name="a.1", method=zipfile.ZIP_DEFLATED):
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", method) as archive, archive.open(name, "w", force_zip64=True) as inner:
        for _ in range(size // 1_000_000):
            inner.write(b"0" * 1_000_000)
    return target.getvalue()


def test_a_zip_bomb_is_stopped_while_it_unpacks():
    packed = bomb(100_000_000)
    assert len(packed) < 1_000_000
    with pytest.raises(DataError, match=r"unpacks to more than 1 MB at a\.1"):
        bundle.unpack(packed, "a.zip", limit=1_000_000)


def test_archives_packed_in_other_ways_are_refused():
    with pytest.raises(DataError, match="unusual way"):
        bundle.unpack(bomb(2_000_000, method=zipfile.ZIP_LZMA), "a.zip")


def test_rows_without_end_are_refused():
    with pytest.raises(DataError, match=r"line 1: .* in a line"):
        read_table(b"1 " * 5000, "a.1", ("PER", "I", "J", "A", "B"), 1)


def test_a_file_of_500_mb_is_refused_before_it_is_read(tmp_path):
    """In a process of its own that may not grow by as much as the file."""
    with (tmp_path / "big.1").open("wb") as file:
        file.truncate(500_000_000)
    (tmp_path / "big.3").write_bytes(PARTS["t.3"])
    script = (
        "import sys; from pathlib import Path; from solver.vessel.data import FileSource; "
        "from solver.outcome import DataError\n"
        "try: FileSource(Path(sys.argv[1])).open('big')\n"
        "except DataError as error: print(error)\n"
        "print(next(line.split()[1] for line in open('/proc/self/status') if line.startswith('VmHWM')))"
    )
    done = subprocess.run([sys.executable, "-c", script, str(tmp_path)], capture_output=True, text=True, check=True)
    said, peak = done.stdout.strip().splitlines()
    assert "477 MB, too large" in said
    assert int(peak) < 300_000  # kB


def test_memory_grows_with_the_text_and_not_beyond():
    """A table costs less than its text does: eight bytes a number, of ten characters and more."""
    rows = 100_000
    payload = b" 1.000000E+01     1     1  1.000000E+00  1.000000E+00\n" * rows
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    table = read_table(payload, "a.1", ("PER", "I", "J", "A", "B"), 1)
    grown = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before
    assert len(table.lines) == rows
    assert grown * 1024 < 4 * len(payload) + 30e6
