"""A case against its data: bands, pairs of frequencies, headings, and what is said where data begin too late."""

import dataclasses

import numpy as np
import pytest

from solver.case import parse_case
from solver.check import check
from solver.model.build import build
from solver.outcome import CaseError, DataError
from solver.vessel.data import QTF
from solver.vessel.fit import fit
from tests.systems import Source

from . import wamit_sets as sets
from .test_quality import consistent, with_pairs


def case(drift="qtf", direction=0.0, low=0.2, wave=(0.25, 1.2), tp=10.0, regular=None, difference=None):
    sea = {"spectrum": "jonswap", "hs": 3.0, "tp": tp, "gamma": 1.0, "direction": f"{direction} deg"}
    if regular:
        sea = {"wave": "regular", "height": 0.2, "period": regular, "direction": f"{direction} deg"}
    return parse_case({
        "slowdrift": 1, "name": "fit", "environment": {"depth": 500.0, "seastates": [sea]},
        "vessel": {
            "mass": 1e7, "centre_of_gravity": [0, 0, 0], "radii_of_gyration": [10, 20, 20],
            "hydrodynamics": {"data": "x", "drift": drift},
        },
        "analyses": {
            "frequency_domain": {
                "wave": {"from": wave[0], "to": wave[1], "step": 0.01}, "low": {"to": low, "step": 0.01},
                "difference": {} if difference is None else {"to": difference},
            }
        },
    })  # fmt: skip


@pytest.fixture(scope="module")
def data():
    return with_pairs(consistent())


def fault(asked, data):
    with pytest.raises(CaseError) as caught:
        fit(asked, data)
    assert len(caught.value.errors) == 1, caught.value
    return caught.value.errors[0]


def test_a_case_within_its_data_is_content(data):
    assert fit(case(), data) == ()
    assert fit(case("newman"), data) == ()
    assert fit(case("none", direction=137.0), data) == ()


def test_each_field_that_asks_for_more_is_named(data):
    found = fault(case(wave=(0.25, 1.3)), data)
    assert found.field == "analyses.frequency_domain.wave.to"
    assert "allowed: ≤ 1.2" in found.message
    found = fault(case(direction=30.0), data)
    assert found.field == "environment.seastates.0.direction"
    assert "meet the vessel at 30 deg" in found.message
    closer = dataclasses.replace(data, qtf=sets.qtf(np.arange(0.2, 1.25, 0.05), [0.0], cross=(), reach=0.151))
    found = fault(case(low=0.2), closer)
    assert found.field == "analyses.frequency_domain.low.to"
    assert "allowed: ≤ 0.1" in found.message
    fit(case(low=0.1), closer)  # and at the limit it is content
    found = fault(case(low=0.1, difference=0.12), closer)
    assert found.field == "analyses.frequency_domain.difference.to"
    assert "allowed: ≤ 0.1" in found.message
    found = fault(case(drift="newman"), dataclasses.replace(data, mean_drift=None))
    assert "use drift: qtf" in found.message
    found = fault(case(), dataclasses.replace(data, qtf=None))
    assert "use newman" in found.message


def test_waves_below_the_pairs_or_the_data_are_said(data):
    low = case(low=0.1, wave=(0.1, 1.2))
    assert "the QTF begins at 0.2 rad/s, the waves at 0.1 rad/s" in fit(low, data)[-1]
    late = consistent(omega=np.arange(0.4, 3.01, 0.05))
    long = case("none", tp=16.0, low=0.1, wave=(0.2, 1.2))
    said = [text for text in fit(long, late) if "long-wave limit" in text]
    assert len(said) == 1
    assert "of the energy of sea 1" in said[0]
    assert not [text for text in fit(case("none", tp=6.0), late) if "long-wave limit" in text]


def test_waves_of_two_directions_without_their_pairs_are_said():
    smooth = consistent()
    held = dataclasses.replace(smooth, mean_drift=np.ones(smooth.excitation.shape))
    asked = case("newman")
    for degrees, count in ((0.0, 0), (90.0, 1)):
        other = asked.environment.seastates[0].model_copy(update={"direction": np.radians(degrees)})
        seas = asked.environment.model_copy(update={"seastates": [*asked.environment.seastates, other]})
        said = fit(asked.model_copy(update={"environment": seas}), held)
        assert len([text for text in said if "different directions" in text]) == count


def test_a_regular_wave_outside_is_refused(data):
    assert fault(case("none", regular=1.5), data).field == "environment.seastates.0.period"


# --- interpolation of the QTF


def test_a_qtf_with_gaps_of_its_own_is_refused():
    qtf = sets.qtf([0.3, 0.5, 0.8], [0.0], cross=())
    for change, text in (
        (np.s_[0, 1, 2, 4], "not finite"), (np.s_[0, 1, 2], "give both"),
    ):  # fmt: skip
        values = qtf.values.copy()
        values[change] = np.nan
        with pytest.raises(DataError, match=text):
            dataclasses.replace(qtf, values=values)
    with pytest.raises(DataError, match="pair of headings"):
        dataclasses.replace(qtf, cross={(0, 1): np.zeros((2, 2, 6), complex)})


def test_the_qtf_is_exact_where_it_is_bilinear():
    omega, headings = np.array([0.3, 0.5, 0.9, 1.2]), np.radians([0.0, 30.0, 90.0])
    m, n = np.meshgrid(omega, omega, indexing="ij")
    base = 1 + m + n + m * n + 2j * (m - n)
    values = (np.array([1.0, 2.0, 4.0])[:, None, None] * base)[..., None] * np.arange(1, 7)
    qtf = QTF(omega, headings, values)
    a, b = np.array([0.4, 1.0]), np.array([0.35, 0.6])
    expected = (1 + a + b + a * b + 2j * (a - b))[:, None] * np.arange(1, 7)
    assert np.allclose(qtf.at(a, b, 0.0), expected)
    assert np.allclose(qtf.at(a, b, np.radians(60.0)), 3.0 * expected)
    assert np.allclose(qtf.at(b, a, 0.0), np.conj(expected))
    half = qtf.at(np.array([0.15]), np.array([0.3]), 0.0)
    assert np.allclose(half, 0.5 * qtf.at(np.array([0.3]), np.array([0.3]), 0.0))
    assert not qtf.at(np.zeros(1), np.zeros(1), 0.0).any()


@pytest.mark.parametrize(
    "omega", [np.arange(0.2, 1.25, 0.05), np.array([0.2, 0.23, 0.3, 0.4, 0.5, 0.6, 0.65, 0.75, 0.9, 1.0, 1.1, 1.2])]
)
@pytest.mark.parametrize(
    ("reach", "low", "high"), [(0.151, 0.2, 1.2), (0.31, 0.25, 1.1), (0.31, 0.47, 1.2), (9.0, 0.1, 1.2)]
)
def test_all_pairs_up_to_the_covered_difference_can_be_had(omega, reach, low, high):
    qtf = sets.qtf(omega, [0.0], cross=(), reach=reach)
    covered = qtf.covered(low, high)
    first = np.linspace(low, high - covered, 4001)
    for difference in np.linspace(0.0, covered, 9):
        qtf.at(first + difference * (high - covered - low > -1), first, 0.0)
    if reach > 1:
        assert covered == pytest.approx(high - low)
        return
    near = np.linspace(low, high, 40001)
    with pytest.raises(DataError, match=r"difference\.to"):
        qtf.at(near[near < high - covered - 0.01] + covered + 0.01, near[near < high - covered - 0.01], 0.0)
    with pytest.raises(DataError, match=r"difference\.to"):
        qtf.check_difference(covered + 0.01, low, high)
    qtf.check_difference(covered, low, high)


def test_hats_and_nodes_are_the_bilinear_table():
    rng = np.random.default_rng(4)
    qtf = sets.qtf([0.3, 0.5, 0.8, 1.1], np.radians([0.0, 90.0]))
    m, n = rng.uniform(0.0, 1.1, 40), rng.uniform(0.0, 1.1, 40)
    for headings in ((0.3, None), (0.3, 1.2)):
        found = np.einsum("wa,abd,wb->wd", qtf.hats(m), qtf.nodal(*headings), qtf.hats(n))
        np.testing.assert_allclose(found, qtf.at(m, n, *headings), rtol=1e-12, atol=1e-9)
    with pytest.raises(DataError, match="above the highest frequency"):
        qtf.hats(np.array([1.2]))


def test_whether_waves_feel_the_bottom_is_judged_at_the_cases_longest(data):
    """1000 m of water beside data for infinite depth: deep for 0.2 rad/s, shallow for 0.15 rad/s and a wave of 40 s."""
    for asked, count in (
        (case(low=0.1, wave=(0.2, 1.2)), 0), (case(low=0.1, wave=(0.15, 1.2)), 1),
        (case("none", regular=15.0), 0), (case("none", regular=40.0), 1),
    ):  # fmt: skip
        deep = asked.model_copy(update={"environment": asked.environment.model_copy(update={"depth": 1000.0})})
        full = dataclasses.replace(data, added_mass_zero=data.added_mass[0])
        for said in (check(deep, Source(full)), build(deep, Source(full)).warnings):
            assert len([text for text in said if "feel the bottom" in text]) == count
