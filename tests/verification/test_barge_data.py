"""The committed wave data of the barge hold what docs/barge.md says of them (the file alone, no Capytaine)."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

FILE = Path(__file__).parents[2] / "examples" / "barge-240x46x10.nc"
DOFS = ["Surge", "Sway", "Heave", "Roll", "Pitch", "Yaw"]
RHO, G, L, B, MASS = 1025.0, 9.807, 240.0, 46.0, 1.1e8


@pytest.fixture(scope="module")
def data():
    with xr.open_dataset(FILE, engine="h5netcdf") as d:
        return d.load()


@pytest.fixture(scope="module")
def force(data):
    """Excitation force, complex, [omega, wave_direction, influenced_dof]."""
    both = data.Froude_Krylov_force + data.diffraction_force
    both = both.transpose("complex", "omega", "wave_direction", "influenced_dof").sel(influenced_dof=DOFS)
    return both.sel(complex="re") + 1j * both.sel(complex="im")


def diagonal(variable, dof):
    return variable.sel(influenced_dof=dof, radiating_dof=dof)


def finite(data):
    """The frequencies of the waves: neither 0 nor infinity."""
    return data.omega.values[1:-1]


def drift(data, dof, omega=None, degrees=None):
    d = data.mean_drift_force.sel(influenced_dof=dof)
    if omega is not None:
        d = d.sel(omega=omega, method="nearest")
    if degrees is not None:
        d = d.sel(wave_direction=np.radians(degrees), method="nearest")
    return d.values


def test_layout(data):
    assert FILE.stat().st_size < 600_000
    np.testing.assert_allclose(data.omega.values[:-1], np.arange(101) * 0.02, atol=1e-9)
    assert np.isinf(data.omega.values[-1])
    np.testing.assert_allclose(np.degrees(data.wave_direction.values), np.arange(32) * 11.25)
    assert 202.5 in np.degrees(data.wave_direction.values).round(9)
    assert list(data.influenced_dof.values) == DOFS == list(data.radiating_dof.values)
    for name in ("added_mass", "radiation_damping"):
        assert set(data[name].dims) == {"omega", "influenced_dof", "radiating_dof"}
        assert np.isfinite(data[name].values).all()
    for name in ("Froude_Krylov_force", "diffraction_force"):
        assert set(data[name].dims) == {"complex", "omega", "wave_direction", "influenced_dof"}
        assert np.isfinite(data[name].isel(omega=slice(0, -1)).values).all()
        assert np.isnan(data[name].isel(omega=-1).values).all()
    assert set(data.mean_drift_force.dims) == {"omega", "wave_direction", "influenced_dof"}
    assert (float(data.rho), float(data.g)) == (RHO, G)
    assert np.isinf(data.water_depth)


def test_attributes_name_no_machine(data):
    texts = [str(v) for variable in (data, *data.variables.values()) for v in variable.attrs.values()]
    assert not [t for t in texts if "/tmp" in t or "/home" in t or "/work" in t or "http" in t]


def test_hydrostatics(data):
    volume = L * B * 10
    assert float(data.disp_volume) == volume
    assert float(data.waterplane_area) == L * B
    np.testing.assert_allclose(data.center_of_mass.values, [0, 0, 5])
    np.testing.assert_allclose(data.rotation_center.values, [0, 0, 5])
    np.testing.assert_allclose(data.center_of_buoyancy.values, [0, 0, -5], atol=0.05)
    k = [0, 0, L * B, L * B**3 / 12 - 10 * volume, L**3 * B / 12 - 10 * volume, 0]
    np.testing.assert_allclose(data.hydrostatic_stiffness.values, np.diag(k) * RHO * G, rtol=1e-12)
    np.testing.assert_allclose(np.diag(data.inertia_matrix), MASS * np.array([1, 1, 1, 26**2, 60**2, 60**2]))


@pytest.mark.parametrize(
    ("dof", "expected", "tolerance"),
    [
        ("Surge", (0.10, 0.10, 0.10, 0.07), 0.005),
        ("Sway", (0.63, 0.81, 0.54, 0.21), 0.02),
        ("Heave", (4.0, 2.26, 1.65, 1.68), 0.05),
        ("Roll", (151, 151, 152, 154), 6.0),
    ],
)
def test_added_mass(data, dof, expected, tolerance):
    a = diagonal(data.added_mass, dof).sel(omega=[0.2, 0.4, 0.6, 0.8], method="nearest") / MASS
    np.testing.assert_allclose(a, expected, atol=tolerance)


def test_no_irregular_frequency_in_heave(data):
    """Without a lid the heave added mass jumps between 1.06 and 1.08 rad/s."""
    heave = diagonal(data.added_mass, "Heave").sel(omega=slice(0.7, 1.5)).values / MASS
    assert np.abs(np.diff(heave, 2)).max() < 0.005


def test_reciprocity(data):
    for name in ("added_mass", "radiation_damping"):
        m = data[name].transpose("omega", "influenced_dof", "radiating_dof").values
        scale = np.sqrt(np.einsum("wi,wj->wij", *[np.abs(np.einsum("wii->wi", m)).max(0, keepdims=True)] * 2))
        assert (np.abs(m - m.transpose(0, 2, 1)) / scale).max() < 0.02


def test_radiation_takes_energy_out(data):
    b = data.radiation_damping.transpose("omega", "influenced_dof", "radiating_dof").values
    size = np.sqrt(np.einsum("wii->wi", b).max(0))
    lowest = np.linalg.eigvalsh((b + b.transpose(0, 2, 1)) / 2 / np.outer(size, size))
    assert lowest.min() > -2e-3


def test_haskind_damping_from_excitation(data, force):
    """B_ii = k omega / (4 pi rho g^2) integral |F_i|^2 d beta, in deep water."""
    for dof in ("Surge", "Sway", "Heave", "Pitch"):
        b = diagonal(data.radiation_damping, dof)
        w = finite(data)
        w = w[(w > 0.19) & (w < 1.01)]
        mean_square = (np.abs(force.sel(influenced_dof=dof, omega=w)) ** 2).mean("wave_direction").values
        haskind = w**3 / (2 * RHO * G**3) * mean_square
        assert np.abs(haskind / b.sel(omega=w).values - 1)[b.sel(omega=w).values > 0.05 * float(b.max())].max() < 0.05


def test_long_waves_lift_the_barge(data, force):
    """At omega = 0 the excitation is rho g A_w in heave; the first frequency is close to it."""
    still = np.zeros(6)
    still[2] = RHO * G * L * B
    np.testing.assert_allclose(force.values[0], np.tile(still, (32, 1)), rtol=1e-6)
    assert np.abs(force.values[1, :, 2] / still[2] - 1).max() < 0.02


def test_mirror_images(data, force):
    """Headings 180 - beta and -beta: the hull has two planes of symmetry."""
    drift_force = data.mean_drift_force.transpose("omega", "wave_direction", "influenced_dof").values[:-1]
    i = np.arange(32)
    for values in (force.values[:-1], drift_force):
        np.testing.assert_allclose(values[:, (16 - i) % 32], values * [-1, 1, 1, 1, -1, -1], rtol=1e-6, atol=1e-3)
        np.testing.assert_allclose(values[:, -i % 32], values * [1, -1, 1, -1, 1, -1], rtol=1e-6, atol=1e-3)


def test_mean_drift_on_the_axes(data):
    assert np.isnan(data.mean_drift_force.isel(omega=-1)).all()
    d = data.mean_drift_force.isel(omega=slice(0, -1))
    assert float(np.abs(d.sel(influenced_dof=["Heave", "Roll", "Pitch"])).max()) == 0
    for dof, degrees in (("Sway", 0), ("Sway", 180), ("Surge", 90), ("Yaw", 0), ("Yaw", 90), ("Yaw", 180)):
        assert np.abs(drift(data, dof, degrees=degrees)[:-1]).max() == 0


def test_mean_drift_of_long_waves_vanishes(data):
    half = RHO * G / 2
    for degrees in np.arange(32) * 11.25:
        assert np.abs(drift(data, "Surge", 0.1, degrees)) < 0.002 * half * B
        assert np.abs(drift(data, "Sway", 0.1, degrees)) < 0.002 * half * L


def test_mean_drift_of_short_waves(data):
    """All of the wave is thrown back: rho g B / 2 head on, rho g L / 2 abeam, where waves no longer move the barge."""
    for omega in (1.4, 1.6, 1.8, 2.0):
        assert drift(data, "Surge", omega, 180) == pytest.approx(-RHO * G * B / 2, rel=0.015)
    for omega in (1.8, 2.0):
        assert drift(data, "Sway", omega, 90) == pytest.approx(RHO * G * L / 2, rel=0.02)
    assert drift(data, "Surge", 1.2, 180) == pytest.approx(-RHO * G * B / 2, rel=0.05)


def test_mean_drift_in_a_jonswap_sea(data):
    """Hs 15.7 m, Tz 13.5 s, gamma 2, towards 202.5 deg: 2 int T S d omega over 0.2 to 1.2 rad/s."""
    gamma, hs = 2.0, 15.7
    w = np.linspace(0.2, 1.2, 2001)
    wp = 2 * np.pi / (13.5 * np.sqrt((11 + gamma) / (5 + gamma)))
    peak = gamma ** np.exp(-0.5 * ((w / wp - 1) / np.where(w < wp, 0.07, 0.09)) ** 2)
    s = (1 - 0.287 * np.log(gamma)) * 5 / 16 * hs**2 * wp**4 / w**5 * np.exp(-1.25 * (wp / w) ** 4) * peak
    surge, sway = (
        2 * np.trapezoid(s * np.interp(w, data.omega.values[:-1], drift(data, dof, degrees=202.5)[:-1]), w)
        for dof in ("Surge", "Sway")
    )
    assert surge == pytest.approx(-0.74e6, rel=0.1)
    assert sway == pytest.approx(-0.66e6, rel=0.1)
