"""WAMIT's files: powers and conventions by hand, both listings, pairs, round trips, and the public VolturnUS-S set."""

import dataclasses

import numpy as np
import pytest

from solver.case.vessel import Vessel
from solver.outcome import DataError
from solver.vessel.data import FileSource, read_bytes, read_files
from solver.vessel.data.bundle import pack
from solver.vessel.data.layout import dump_netcdf
from solver.vessel.data.wamit import conventions_of, read_wamit, write_wamit
from solver.vessel.drift import Drift
from solver.vessel.quality import quality
from solver.vessel.rigid import about_cg, hydrostatic_stiffness, turning

from . import wamit_sets as sets

BY_HAND = {
    "a.1": """ Header line that NUMHDR writes
 -1.0 1 1 5.0
 -1.0 5 5 7.0
  0.0 1 1 2.0
  0.0 5 5 3.0
 10.0 1 1 0.4 0.1
 10.0 5 5 0.6 0.2
  5.0 1 1 0.3 0.3
  5.0 5 5 0.5 0.4
""",
    "a.3": "\n".join(
        f"{period} {beta} {mode} {mod} {phase} {mod * np.cos(np.radians(phase))} {mod * np.sin(np.radians(phase))}"
        for period, mod in ((10.0, 2.0), (5.0, 0.3))
        for beta in (0.0, 180.0)
        for mode, phase in zip(range(1, 7), (90.0, 0.0, 30.0, -45.0, 60.0, 180.0), strict=True)
    ),
    "a.8": "10.0 0.0 0.0 1 0.5 0.0 0.5 0.0\n10.0 0.0 0.0 6 0.25 180.0 -0.25 0.0\n"
    "5.0 0.0 0.0 1 0.7 0.0 0.7 0.0\n5.0 0.0 0.0 6 0.0 0.0 0.0 0.0\n",
    "a.12d": "10. 10. 0. 0. 1 0.5 0. 0.5 0.\n5. 10. 0. 0. 1 0.1 90. 0. 0.1\n5. 5. 0. 0. 1 0.7 0. 0.7 0.\n",
    "a.hst": "3 3 4.0\n4 4 1.5\n5 5 2.5\n3 5 -0.5\n5 3 -0.5\n",
}
OPTIONS = sets.OPTIONS.model_copy(update={"length": 2.0, "density": 1000.0, "gravity": 10.0})


def texts(**changes):
    return {name: text.encode() for name, text in (BY_HAND | changes).items() if text}


def test_powers_of_the_length_and_conventions_by_hand():
    data = read_wamit(texts(), OPTIONS)
    long, short = 2 * np.pi / 10, 2 * np.pi / 5
    assert np.allclose(data.omega, [long, short])
    assert np.allclose(data.added_mass[:, 0, 0], 1000 * 2**3 * np.array([0.4, 0.3]))
    assert np.allclose(data.added_mass[:, 4, 4], 1000 * 2**5 * np.array([0.6, 0.5]))
    assert np.allclose(data.damping[:, 4, 4], 1000 * 2**5 * np.array([0.2 * long, 0.4 * short]))
    assert data.added_mass_zero[0, 0] == 1000 * 2**3 * 5.0  # period -1: infinite
    assert data.added_mass_infinite[4, 4] == 1000 * 2**5 * 3.0  # period 0
    assert np.allclose(data.headings, [0.0, np.pi])
    assert np.allclose(data.excitation[0, 0, 0], 1000 * 10 * 2**2 * 2.0j)  # phase 90 deg, e^{+iωt}
    assert np.allclose(data.excitation[1, 1, 4], 1000 * 10 * 2**3 * 0.3 * np.exp(1j * np.radians(60)))
    assert np.allclose(data.mean_drift[:, 0, 0], 1000 * 10 * 2 * np.array([0.5, 0.7]))
    assert np.allclose(data.mean_drift[:, 0, 5], 1000 * 10 * 2**2 * np.array([-0.25, 0.0]))
    assert not data.mean_drift[..., 1:5].any()
    assert data.hydrostatic_stiffness[2, 2] == 1000 * 10 * 2**2 * 4.0
    assert data.hydrostatic_stiffness[2, 4] == 1000 * 10 * 2**3 * -0.5
    assert data.hydrostatic_stiffness[4, 4] == 1000 * 10 * 2**4 * 2.5
    upper = data.qtf.at(np.array(short), np.array(long), 0.0)  # the wave of 5 s first: e^{i(ω1-ω2)t}
    assert np.allclose(upper[0], 1000 * 10 * 2 * 0.1j)
    assert np.allclose(data.qtf.at(np.array(long), np.array(short), 0.0)[0], -1000 * 10 * 2 * 0.1j)
    assert not data.reference_known
    assert "periods" in data.provenance["assumed"][0]


def test_a_direction_listed_twice_counts_once_and_must_agree():
    rows = BY_HAND["a.3"].splitlines()
    again = [row.replace(" 0.0 ", " 360.0 ", 1) for row in rows if row.split()[1] == "0.0"]
    data = read_wamit(texts(**{"a.3": "\n".join(rows + again)}), OPTIONS)
    assert np.array_equal(data.excitation, read_wamit(texts(), OPTIONS).excitation)
    other = again[0].replace(" 2.0 90.0 ", " 3.0 90.0 ").split()
    again[0] = " ".join([*other[:-1], "3.0"])
    with pytest.raises(DataError, match="headings 360 and 0 are one direction but their values differ"):
        read_wamit(texts(**{"a.3": "\n".join(rows + again)}), OPTIONS)


def test_dimensional_files_are_taken_as_they_are():
    data = read_wamit(texts(), OPTIONS.model_copy(update={"length": None, "values": "dimensional"}))
    assert np.allclose(data.damping[:, 4, 4], [0.2, 0.4])
    assert np.allclose(data.excitation[0, 0, 0], 2.0j)
    assert data.hydrostatic_stiffness[4, 4] == 2.5


def test_frequencies_in_the_first_column_and_their_limits():
    """The same body with rad/s listed: 0 is then zero frequency and -1 infinite."""
    listed = {
        "-1.0": "0.0",
        "0.0": "-1.0",
        "10.0": "0.62831853",
        "10.": "0.62831853",
        "5.0": "1.25663706",
        "5.": "1.25663706",
    }

    def swap(text, columns):
        rows = [line.split() for line in text.splitlines() if not line.startswith(" Header")]
        return "\n".join(" ".join([*(listed[word] for word in row[:columns]), *row[columns:]]) for row in rows)

    changed = {name: swap(text, 2 if name == "a.12d" else 1) for name, text in BY_HAND.items() if name != "a.hst"}
    a, b = read_wamit(texts(), OPTIONS), read_wamit(texts(**changed), OPTIONS)
    for field in (
        "omega",
        "added_mass",
        "damping",
        "excitation",
        "added_mass_zero",
        "added_mass_infinite",
        "mean_drift",
    ):
        assert np.allclose(getattr(a, field), getattr(b, field), rtol=1e-7), field
    assert np.allclose(a.qtf.values, b.qtf.values)
    forced = read_wamit(texts(**changed), OPTIONS.model_copy(update={"first_column": "periods"}))
    assert any("check first_column" in text for text in forced.warnings)


def test_an_unclear_first_column_is_asked_for():
    flat = "\n".join(f"{p} 0 {m} 1 0 1 0" for p in (10.0, 5.0) for m in range(1, 7))
    with pytest.raises(DataError, match="give first_column"):
        read_wamit(texts(**{"a.3": flat}), OPTIONS)
    told = OPTIONS.model_copy(update={"first_column": "periods"})
    assert np.allclose(read_wamit(texts(**{"a.3": flat}), told).omega, [2 * np.pi / 10, 2 * np.pi / 5])


def test_haskind_forces_stand_in_and_are_compared():
    only = read_wamit(texts(**{"a.3": "", "a.2": BY_HAND["a.3"]}), OPTIONS)
    assert np.allclose(only.excitation, read_wamit(texts(), OPTIONS).excitation)
    other = read_wamit(texts(**{"a.2": BY_HAND["a.3"].replace("10.0 0.0 1 2.0 90.0", "10.0 0.0 1 2.0 90.0")}), OPTIONS)
    assert [text for text in other.warnings if "Haskind" in text] == []
    rows = BY_HAND["a.3"].splitlines()
    rows[0] = "10.0 0.0 1 1.0 90.0 0.0 1.0"
    assert any(
        "differ from those by diffraction" in t for t in read_wamit(texts(**{"a.2": "\n".join(rows)}), OPTIONS).warnings
    )


def test_fortran_numbers():
    odd = BY_HAND["a.1"].replace("10.0 1 1 0.4 0.1", "1.0D+01 1 1 4.0d-1 1.0-100")
    data = read_wamit(texts(**{"a.1": odd}), OPTIONS)
    assert data.added_mass[0, 0, 0] == pytest.approx(1000 * 8 * 0.4)
    assert data.damping[0, 0, 0] == pytest.approx(1e-100 * 8000 * 2 * np.pi / 10)


@pytest.mark.parametrize(
    ("name", "old", "new", "text"),
    [
        ("a.1", "10.0 5 5 0.6 0.2", "10.0 5 5 0.6", "line 7: there is no damping"),
        ("a.1", "10.0 5 5 0.6 0.2", "10.0 5 5", "line 7: 3 columns; expected 4 or 5"),
        ("a.1", "10.0 5 5 0.6 0.2", "10.0 5 5 **** 0.2", r"line 7: \*\*\*\* is a number too wide"),
        ("a.1", "10.0 5 5 0.6 0.2", "10.0 5 5 NaN 0.2", "line 7: 'NaN' is not a finite number"),
        ("a.1", "10.0 5 5 0.6 0.2", "10.0 5 5 1e999 0.2", "line 7: '1e999' is not a finite"),
        ("a.1", "10.0 5 5 0.6 0.2", "10.0 5 5 1_0 0.2", "line 7: '1_0' is not"),
        ("a.1", "10.0 5 5 0.6 0.2", "10.0 7 5 0.6 0.2", "line 7: I is 7; allowed: 1 to 6; several bodies"),
        ("a.1", "10.0 5 5 0.6 0.2", "10.0 1 1 0.6 0.2", "line 7: the same entry as in line 6"),
        ("a.1", "10.0 5 5 0.6 0.2\n", "", "I 5, J 5 is missing at 0.62832 rad/s"),
        ("a.1", "10.0 5 5 0.6 0.2", "-3.0 5 5 0.6 0.2", "line 7: the first column is -3"),
        ("a.1", "10.0 5 5 0.6 0.2", "10.0001 5 5 0.6 0.2", "all but the same"),
        ("a.3", "10.0 180.0 3", "10.0 1800.0 3", "the heading is 1800"),
        ("a.3", "10.0 180.0 3 2.0", "10.0 180.0 3 2.5", "line 9: the modulus 2.5 is not that of"),
        ("a.3", "10.0 180.0 3", "10.0 170.0 3", "mixes headings"),
        ("a.3", "10.0 ", "9.0 ", "not in the .1 file"),
        ("a.8", "5.0 0.0 0.0 6", "5.0 0.0 0.0 5", "missing at"),
        ("a.12d", "5. 10. 0. 0. 1 0.1 90. 0. 0.1\n", "10. 5. 0. 0. 3 0.1 90. 0. 0.1\n", "lack modes"),
        ("a.hst", "4 4 1.5\n", "", r"C\(4,4\) is missing"),
        ("a.hst", "4 4 1.5", "4 4 1.5 3", "line 2: 4 columns; expected 3"),
        ("a.hst", "4 4 1.5", "4 4 1.5" + " " * 3000, "allowed: at most 2000 in a line"),
    ],
)  # fmt: skip
def test_a_fault_is_told_with_its_line(name, old, new, text):
    assert old in BY_HAND[name]
    with pytest.raises(DataError, match=text) as caught:
        read_wamit(texts(**{name: BY_HAND[name].replace(old, new)}), OPTIONS)
    assert name in str(caught.value) or "first_column" in str(caught.value)


# --- pairs of frequencies and headings


def pairs(qtf, triangle="upper", conjugate=False, first="period"):
    """Text of a .12d, one triangle or both, in a convention of choice."""
    rows = []
    keep = {"upper": lambda m, n: m >= n, "lower": lambda m, n: m <= n, "both": lambda m, n: True}[triangle]
    for h, angle in enumerate(np.degrees(qtf.headings)):
        for m in range(qtf.omega.size):
            for n in range(qtf.omega.size):
                if not keep(m, n) or np.isnan(qtf.values[h, m, n, 0]):
                    continue
                axis = 2 * np.pi / qtf.omega if first == "period" else qtf.omega
                for i in range(6):
                    value = qtf.values[h, m, n, i] / (1000 * 10 * 2 ** (1 + (i > 2)))
                    value = np.conj(value) if conjugate else value
                    head = f"{axis[m]:.9f} {axis[n]:.9f} {angle} {angle} {i + 1}"
                    rows.append(f"{head} {abs(value):.9e} 0 {value.real:.9e} {value.imag:.9e}")
    return "\n".join(rows)


@pytest.mark.parametrize("triangle", ["upper", "lower", "both"])
@pytest.mark.parametrize("conjugate", [False, True])
@pytest.mark.parametrize("first", ["period", "frequency"])
def test_each_listing_of_pairs_gives_the_same_qtf(triangle, conjugate, first):
    qtf = sets.qtf([0.63, 0.8, 1.0, 1.25], np.radians([0, 90]), cross=())
    options = OPTIONS.model_copy(update={"pair_order": "second-minus-first" if conjugate else "first-minus-second"})
    options = options.model_copy(update={"pair_columns": "auto" if first == "period" else "frequencies"})
    found = read_wamit(texts(**{"a.12d": pairs(qtf, triangle, conjugate, first)}), options).qtf
    assert np.allclose(found.values, qtf.values)
    assert np.allclose(found.omega, qtf.omega)


def test_pairs_that_may_be_either_are_asked_for():
    qtf = sets.qtf([0.7, 0.9, 1.1], [0.0], cross=())
    wide = (
        BY_HAND["a.1"].replace("10.0 ", "60.0 "),
        BY_HAND["a.3"].replace("10.0 ", "60.0 "),
        BY_HAND["a.8"].replace("10.0", "60.0"),
    )
    changed = dict(zip(("a.1", "a.3", "a.8"), (part.replace("5.0 ", "0.1 ") for part in wide), strict=True))
    with pytest.raises(DataError, match="give pair_columns"):
        read_wamit(texts(**{**changed, "a.12d": pairs(qtf)}), OPTIONS)


def test_both_triangles_that_are_not_hermitian_are_refused():
    qtf = sets.qtf([0.63, 0.8, 1.25], [0.0], cross=())
    rows = pairs(qtf, "both").splitlines()
    where = 6  # the first row of the first pair of two frequencies
    words = rows[where].split()
    assert words[0] != words[1]
    words[-1] = f"{-float(words[-1]):.9e}"
    rows[where] = " ".join(words)
    with pytest.raises(DataError, match="not Hermitian"):
        read_wamit(texts(**{"a.12d": "\n".join(rows)}), OPTIONS)


def test_pairs_of_small_differences_only():
    qtf = sets.qtf([0.63, 0.8, 1.0, 1.25], [0.0], cross=(), reach=0.26)
    found = read_wamit(texts(**{"a.12d": pairs(qtf)}), OPTIONS).qtf
    assert found.reach == pytest.approx(0.25)
    near = found.at(np.array([0.9, 1.1]), np.array([0.8, 1.0]), 0.0)
    assert np.isfinite(near).all()
    with pytest.raises(DataError, match=r"differences up to 0.25 rad/s"):
        found.at(np.array([1.25]), np.array([0.63]), 0.0)
    rows = pairs(sets.qtf([0.63, 0.8, 1.0, 1.25], [0.0], cross=())).splitlines()
    with pytest.raises(DataError, match="cut off"):
        read_wamit(texts(**{"a.12d": "\n".join(rows[:-6])}), OPTIONS)


def test_bidirectional_pairs():
    data = dataclasses.replace(
        sets.whole(), qtf=sets.qtf([0.5, 0.8, 1.1], np.radians([0, 40, 80]), cross=((0, 1), (1, 2)))
    )
    found = read_wamit(sets.files(data), sets.OPTIONS).qtf
    m, n = np.array([1.1]), np.array([0.5])
    assert np.allclose(found.at(m, n, 0.0, np.radians(40)), data.qtf.cross[0, 1][2, 0], rtol=1e-5)
    back = found.at(n, m, np.radians(40), 0.0)
    assert np.allclose(back, np.conj(data.qtf.cross[0, 1][2, 0]), rtol=1e-5)
    mixed = found.at(m, n, np.radians(20), np.radians(40))
    assert np.allclose(mixed, 0.5 * (data.qtf.cross[0, 1][2, 0] + data.qtf.values[1, 2, 0]), rtol=1e-4, atol=1)
    assert found.knows(0.0, np.radians(40))
    assert not found.knows(0.0, np.radians(80))
    with pytest.raises(DataError, match="no pairs of these two headings"):
        found.at(m, n, 0.0, np.radians(80))


def test_a_pair_of_headings_both_ways_round():
    """Once more with the headings swapped: the conjugate is the same data, anything else a contradiction."""
    qtf = sets.qtf([0.5, 0.8, 1.1], np.radians([0, 40]), cross=((0, 1),))
    files = sets.files(dataclasses.replace(sets.whole(), qtf=qtf))
    name = next(name for name in files if name.endswith(".12d"))
    once = files[name].decode()
    crossed = [row for row in map(str.split, once.splitlines()) if len(row) == 9 and row[2] != row[3]]
    twins = [f"{r[1]} {r[0]} {r[3]} {r[2]} {r[4]} {r[5]} 0 {r[7]} {-float(r[8]):.9e}" for r in crossed]
    found = read_wamit(files | {name: (once + "\n".join(twins)).encode()}, sets.OPTIONS).qtf
    assert np.allclose(found.cross[0, 1], read_wamit(files, sets.OPTIONS).qtf.cross[0, 1])
    twins = [f"{r[1]} {r[0]} {r[3]} {r[2]} {r[4]} {r[5]} 0 {r[7]} {r[8]}" for r in crossed]
    with pytest.raises(DataError, match="both ways round"):
        read_wamit(files | {name: (once + "\n".join(twins)).encode()}, sets.OPTIONS)


def test_drift_of_two_directions_takes_the_pairs_of_headings():
    data = dataclasses.replace(sets.whole(), qtf=sets.qtf([0.5, 0.8, 1.1], np.radians([0, 40, 80]), cross=((0, 1),)))
    drift, m, n = Drift(data, "qtf", np.radians(10)), np.array([1.1]), np.array([0.5])
    a, b, c = np.radians([10, 50, 90])
    turn = turning(np.radians(10))
    assert np.allclose(drift(m, n, a, b), data.qtf.cross[0, 1][2, 0] @ turn.T)
    assert np.allclose(drift(n, m, b, a), np.conj(drift(m, n, a, b)))
    assert drift.warnings((a, b)) == ()
    half = 0.5 * (data.qtf.values[0, 2, 0] + data.qtf.values[2, 2, 0]) @ turn.T
    assert np.allclose(drift(m, n, a, c), half)
    assert "half the sum" in drift.warnings((a, c))[0]


# --- round trips


def printed(parts):
    """Rows as numbers, headings within a turn, one of two names of a direction."""
    found = {}
    for name, payload in parts.items():
        columns = {".3": (1,), ".2": (1,), ".4": (1,), ".8": (1, 2), ".9": (1, 2), ".12d": (2, 3)}.get(
            name[name.rfind(".") :], ()
        )
        index = {".1": 3, ".hst": 2, ".12d": 5, ".8": 4, ".9": 4}.get(name[name.rfind(".") :], 3)
        rows = {}
        for line in payload.decode().splitlines():
            words = line.split()
            key = [round(float(word) % 360, 6) if k in columns else float(word) for k, word in enumerate(words[:index])]
            rows.setdefault(tuple(key), words[index:])  # of -180 and 180 the first
        found[name] = rows
    return found


def same_to_printed_precision(a, b, digits=6):
    assert a.keys() == b.keys()
    for name, rows in a.items():
        wide = name.endswith((".3", ".4", ".12d", ".8", ".9"))
        for key, words in rows.items():
            if key not in b[name]:
                assert all(float(word) == 0.0 for word in words), (name, key)  # zero by symmetry
                continue
            other = b[name][key]
            for k, (one, two) in enumerate(zip(words, other, strict=True)):
                if wide and k < 2:
                    continue  # modulus and phase follow from real and imaginary part
                assert f"{float(one):.{digits}e}" == f"{float(two):.{digits}e}", (name, key, one, two)


@pytest.mark.parametrize("drift", ["all", "plane"])
def test_wamit_to_database_to_wamit(drift):
    data = sets.whole(drift=drift)
    first = sets.files(data)
    read = read_wamit(first, conventions_of(data, 10.0))
    second = write_wamit(read, "t")
    assert sorted(second) == sorted(first)
    assert {"t.8" if drift == "plane" else "t.9", "t.12d", "t.4"} <= first.keys()
    same_to_printed_precision(printed(first), printed(second))
    for field in (
        "added_mass",
        "damping",
        "excitation",
        "mean_drift",
        "motions",
        "hydrostatic_stiffness",
        "added_mass_zero",
    ):
        ours, theirs = getattr(read, field), getattr(data, field)
        assert np.allclose(ours, theirs, rtol=2e-6, atol=2e-6 * np.abs(theirs).max()), field


def test_another_length_gives_the_same_data():
    data = sets.whole()
    read = read_wamit(sets.files(data, 3.0), conventions_of(data, 3.0))
    assert np.allclose(read.damping, data.damping, rtol=2e-6)
    assert np.allclose(read.qtf.values, data.qtf.values, rtol=2e-5, atol=1e-2)


def test_the_public_set_reads_and_comes_back():
    files = sets.volturnus()
    data = read_wamit(files, sets.VOLTURNUS)
    assert (data.omega.size, data.headings.size, data.qtf.omega.size) == (100, 36, 46)
    # the limits lie on the curves: period -1 is zero frequency, 0 is infinite
    assert data.added_mass_zero[0, 0] == pytest.approx(data.added_mass[0, 0, 0], rel=2e-3)
    assert data.added_mass_infinite[4, 4] == pytest.approx(data.added_mass[-1, 4, 4], rel=5e-3)
    assert data.hydrostatic_stiffness[2, 2] == pytest.approx(443.0486 * 1025 * 9.80665)
    # Froude-Krylov and inertia of a long wave: heave near C33, surge a quarter period ahead of the crest
    assert abs(data.excitation[0, 0, 2]) == pytest.approx(data.hydrostatic_stiffness[2, 2], rel=0.03)
    assert np.degrees(np.angle(data.excitation[0, 0, 0])) == pytest.approx(90.0, abs=0.5)
    assert read_bytes(dump_netcdf(data), "v.nc").qtf.values.tobytes() == data.qtf.values.tobytes()
    doubts = {check.name: check.state for check in quality(data, 0.2, 1.2)}
    assert {name for name, state in doubts.items() if state == "warning"} == {
        "spacing"
    }  # heave damping has a sharp peak
    assert doubts["haskind"] == doubts["kramers-kronig"] == doubts["long-wave"] == "ok"
    again = write_wamit(data, "umainesemi")
    before, after = printed(files), printed(again)
    for kind in ("umainesemi.1", "umainesemi.3", "umainesemi.hst"):
        same_to_printed_precision({kind: by_index(before[kind])}, {kind: by_index(after[kind])}, 6)
    # .12d has five digits, and its rows the heading 0 alone
    same_to_printed_precision({"umainesemi.12d": by_index(before["umainesemi.12d"])},
                              {"umainesemi.12d": by_index(after["umainesemi.12d"])}, 5)  # fmt: skip


def by_index(rows):
    """Periods by rank: what was printed with five digits is printed with seven."""
    periods = sorted({round(float(f"{key[0]:.4e}"), 9) for key in rows})
    rank = {period: k for k, period in enumerate(periods)}
    pairs = any(len(key) == 5 for key in rows)

    def short(key):
        head = [rank[round(float(f"{part:.4e}"), 9)] for part in key[: 2 if pairs else 1]]
        return (*head, *key[len(head) :])

    return rows if not any(len(key) > 2 for key in rows) else {short(key): words for key, words in rows.items()}


def test_the_reference_point_moves_to_the_centre_of_gravity():
    """Files about another point, said in the case, are the same body; the weight in the .hst moves with it."""
    data = dataclasses.replace(sets.whole(), reference_known=True)
    point, vessel = np.array([3.0, -1.0, 4.0]), {"mass": 1e6, "centre_of_gravity": (1.0, 0.5, -2.0)}
    vessel |= {"radii_of_gyration": (5.0, 5.0, 5.0), "hydrostatics": {"displaced_volume": 5000.0}}
    moved, found = data.moved_to(point), []
    for one, where in ((data, (0.0, 0.0, 0.0)), (moved, tuple(point))):
        read = read_wamit(write_wamit(one, "t", 10.0), conventions_of(one, 10.0))
        body = Vessel.model_validate(vessel | {"hydrodynamics": {"data": "t", "reference_point": where}})
        found.append((about_cg(read, body), hydrostatic_stiffness(body, read)))
    (first, k_first), (second, k_second) = found
    for field in ("added_mass", "damping", "excitation", "mean_drift"):
        ours, theirs = getattr(first, field), getattr(second, field)
        assert np.allclose(ours, theirs, rtol=1e-4, atol=3e-6 * np.abs(theirs).max()), field
    assert np.allclose(k_first, k_second, rtol=1e-5, atol=1e-5 * np.abs(k_first).max())
    heel = data.moved_to(np.array(vessel["centre_of_gravity"])).hydrostatic_stiffness[3, 3]
    assert k_first[3, 3] == pytest.approx(heel + 1025 * 9.807 * 5000 * (2.0 + 2.0), rel=1e-5)


# --- where sets come from


def test_a_stem_a_file_or_a_folder(tmp_path):
    parts = sets.files()
    for name, payload in parts.items():
        (tmp_path / name.replace("t.", "Hull.")).write_bytes(payload)
    (tmp_path / "notes.txt").write_text("of no concern")
    source = FileSource(tmp_path)
    found = [source.open(name, sets.OPTIONS) for name in ("Hull", "hull", "Hull.1", "Hull.12d", ".")]
    assert {data.content_hash for data in found} == {found[0].content_hash}
    assert found[0].provenance["files"][0]["name"] == "Hull.1"
    (tmp_path / "other.1").write_bytes(parts["t.1"])
    with pytest.raises(DataError, match="2 runs"):
        source.open(".", sets.OPTIONS)
    assert source.open("Hull", sets.OPTIONS).content_hash == found[0].content_hash
    for reference in ("nothing", "nothing.1", "Hull.8"):
        with pytest.raises(DataError, match="no such file"):
            source.open(reference, sets.OPTIONS)
    with pytest.raises(DataError, match="ULEN"):
        source.open("Hull")


def test_a_confined_source_follows_no_link_out(tmp_path):
    inner = tmp_path / "inner"
    inner.mkdir()
    for name, payload in sets.files().items():
        (tmp_path / name).write_bytes(payload)
        (inner / name).symlink_to(tmp_path / name)
    with pytest.raises(DataError, match="outside"):
        FileSource(inner, confined=True).open("t", sets.OPTIONS)
    assert FileSource(inner).open("t", sets.OPTIONS).name == "t"


def test_a_packed_set_carries_its_conventions():
    packed = pack(sets.files(), sets.OPTIONS)
    assert packed == pack(dict(reversed(sets.files().items())), sets.OPTIONS)
    data = read_files({"t.zip": packed})
    assert data.content_hash == read_files(sets.files(), sets.OPTIONS).content_hash
    with pytest.raises(DataError, match="uploaded with 10"):
        read_files({"t.zip": packed}, sets.OPTIONS.model_copy(update={"length": 2.0}))
