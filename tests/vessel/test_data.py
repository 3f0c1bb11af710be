"""Hydrodynamic data: what the reader understands, what it refuses and how, interpolation and change of reference."""

import contextlib
import dataclasses
import json
import subprocess
import sys

import numpy as np
import pytest

from solver.outcome import DataError
from solver.vessel.data import MAX_BYTES, QTF, FileSource, read_bytes
from solver.vessel.data.hydrodynamics import transport
from solver.vessel.quality import quality_warnings

from . import synthetic


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("data")


@pytest.fixture(scope="module")
def source():
    return synthetic.dataset()


@pytest.fixture(scope="module")
def data(folder, source):
    return read_bytes(synthetic.to_bytes(source, folder), "synthetic.nc")


def test_everything_in_the_file_arrives(data, source):
    inside = slice(1, -1)
    assert np.array_equal(data.omega, source.omega.values[inside])
    assert np.allclose(data.added_mass, source.added_mass.values[inside])
    assert np.allclose(data.damping, source.radiation_damping.values[inside])
    assert np.allclose(data.added_mass_zero, source.added_mass.values[0])
    assert np.allclose(data.added_mass_infinite, source.added_mass.values[-1])
    total = (source.Froude_Krylov_force + source.diffraction_force).values[inside]
    assert np.allclose(data.excitation, np.conj(total))  # e^{-i omega t} in the file
    assert np.allclose(data.mean_drift, source.mean_drift_force.values[inside])
    assert data.displaced_volume == pytest.approx(60 * 20 * 6)
    assert (data.density, data.gravity, data.depth) == (synthetic.RHO, synthetic.G, np.inf)
    assert np.array_equal(data.reference_point, [0, 0, 2])
    assert data.reference_known
    assert data.excitation_zero is None
    assert len(data.content_hash) == 64
    assert data.warnings == ()
    assert json.loads(json.dumps(data.describe(), allow_nan=False))["depth"] is None


def test_order_of_axes_names_frequencies_and_headings_does_not_matter(data, source, folder):
    shuffled = source.isel(omega=[5, 0, 21, *range(6, 21), 4, 3, 2, 1], wave_direction=[*range(9, 16), *range(9)])
    shuffled = shuffled.isel(influenced_dof=[3, 1, 0, 5, 4, 2], radiating_dof=[1, 0, 2, 4, 3, 5])
    shuffled = shuffled.assign_coords(wave_direction=((shuffled.wave_direction.values + np.pi) % (2 * np.pi)) - np.pi)
    shuffled = shuffled.assign_coords(
        influenced_dof=[f"hull__{n}" for n in shuffled.influenced_dof.values],
        radiating_dof=[n.lower() for n in shuffled.radiating_dof.values],
    )
    shuffled = shuffled.transpose("radiating_dof", "wave_direction", "influenced_dof", "omega", "space_coordinate")
    other = read_bytes(synthetic.to_bytes(shuffled, folder), "other.nc")
    for field in ("omega", "headings", "added_mass", "damping", "excitation", "mean_drift", "hydrostatic_stiffness"):
        assert np.allclose(getattr(other, field), getattr(data, field)), field


def test_netcdf_3_and_a_total_excitation_are_read_too(data, source, folder):
    total = source.assign(excitation_force=source.Froude_Krylov_force + source.diffraction_force)
    total = total.drop_vars(["Froude_Krylov_force", "diffraction_force"])
    other = read_bytes(synthetic.to_bytes(total, folder, engine="scipy"), "old.nc")
    assert np.allclose(other.excitation, data.excitation)


def test_a_file_without_edges_has_none(source, folder):
    plain = synthetic.dataset(edges=False).drop_vars(["mean_drift_force", "hydrostatic_stiffness", "rotation_center"])
    data = read_bytes(synthetic.to_bytes(plain, folder), "plain.nc")
    assert (data.added_mass_zero, data.added_mass_infinite, data.mean_drift) == (None, None, None)
    assert not data.reference_known
    assert "reference_point" in data.warnings[0]
    with pytest.raises(DataError, match="mean_drift_force"):
        data.mean_drift_at(np.array([0.5]), 0.0)
    with pytest.raises(DataError, match="below the lowest frequency"):
        data.excitation_at(np.array([0.05]), 0.0)
    with pytest.raises(DataError, match="below the lowest frequency"):
        data.radiation_at(np.array([0.05]))


def _nan(source):
    bad = source.copy(deep=True)
    bad.added_mass.values[4, 2, 2] = np.nan
    return bad


SPOILT = {
    "no added mass": (lambda s: s.drop_vars("added_mass"), "added_mass"),
    "no excitation": (lambda s: s.drop_vars(["Froude_Krylov_force", "diffraction_force"]), "excitation_force"),
    "half an excitation": (lambda s: s.drop_vars("diffraction_force"), "diffraction_force"),
    "no frequencies": (lambda s: s.rename(omega="frequency"), "omega"),
    "no headings": (lambda s: s.isel(wave_direction=0, drop=True), "wave_direction"),
    "wrong axes": (lambda s: s.assign(added_mass=s.added_mass.isel(radiating_dof=0, drop=True)), "axes"),
    "NaN": (_nan, "NaN"),
    "NaN drift": (lambda s: s.assign(mean_drift_force=s.mean_drift_force * np.nan), "mean_drift_force"),
    "real excitation": (
        lambda s: s.assign(diffraction_force=abs(s.diffraction_force), Froude_Krylov_force=abs(s.diffraction_force)),
        "imaginary",
    ),
    "degrees": (lambda s: s.assign_coords(wave_direction=np.arange(16) * 22.5), "degrees"),
    "other names": (lambda s: s.assign_coords(radiating_dof=list("abcdef")), "radiating_dof"),
    "a DOF twice": (
        lambda s: s.assign_coords(influenced_dof=["Surge", "Surge", *synthetic.NAMES[2:]]),
        "influenced_dof",
    ),
    "five DOFs": (lambda s: s.isel(radiating_dof=slice(5)), "radiating_dof"),
    "forward speed": (lambda s: s.assign_coords(forward_speed=3.0), "forward_speed"),
    "no density": (lambda s: s.assign_coords(rho=-1.0), "rho"),
    "negative frequency": (lambda s: s.assign_coords(omega=-s.omega.values), "omega"),
    "text": (lambda s: s.assign(added_mass=s.added_mass.astype(str)), "added_mass"),
    "only the edges": (lambda s: s.isel(omega=[0, -1]), "omega"),
    "strange point": (
        lambda s: s.drop_vars("rotation_center").assign(rotation_center=("two", [1.0, 2.0])),
        "rotation_center",
    ),
}


@pytest.mark.parametrize("fault", SPOILT)
def test_a_spoilt_file_is_refused_in_one_sentence(fault, source, folder):
    spoil, word = SPOILT[fault]
    payload = synthetic.to_bytes(spoil(source), folder)
    with pytest.raises(DataError, match=word) as caught:
        read_bytes(payload, "spoilt.nc")
    assert str(caught.value).startswith("spoilt.nc: ")
    assert "\n" not in str(caught.value)


def test_what_is_not_netcdf_is_refused(source, folder):
    payload = synthetic.to_bytes(source, folder)
    old = synthetic.to_bytes(source, folder, engine="scipy")
    for spoilt in (
        b"",
        b"omega,added mass\n",
        payload[: len(payload) // 2],
        payload[:40],
        old[:300],
        payload[:8] + bytes(500),
    ):
        with pytest.raises(DataError, match=r"^f\.nc: "):
            read_bytes(spoilt, "/secret/place/f.nc")
    with pytest.raises(DataError, match="at most 64 MB"):
        read_bytes(bytes(MAX_BYTES + 1), "f.nc")


def test_damaged_bytes_never_give_another_error(source, folder):
    payload = synthetic.to_bytes(source, folder)
    rng = np.random.default_rng(7)
    for _ in range(60):
        spoilt = bytearray(payload)
        for place in rng.integers(8, len(payload), 20):
            spoilt[place] = rng.integers(256)
        with contextlib.suppress(DataError):
            read_bytes(bytes(spoilt), "f.nc")


def test_warnings_name_threshold_and_remedy(source, folder):
    bad = source.copy(deep=True)
    bad.radiation_damping.values[3, 2, 2] *= -1
    bad.added_mass.values[5, 0, 4] += 0.1 * np.sqrt(bad.added_mass.values[5, 0, 0] * bad.added_mass.values[5, 4, 4])
    warnings = quality_warnings(read_bytes(synthetic.to_bytes(bad, folder), "w.nc"), 0.0, np.inf)
    assert any("surge and pitch" in text and "threshold 2 %" in text for text in warnings)
    assert any("heave is negative at 0.3 rad/s" in text and "lid" in text for text in warnings)


# --- interpolation


def test_excitation_at_nodes_between_and_round_the_circle(data):
    assert np.allclose(data.excitation_at(data.omega, np.pi / 4), data.excitation[:, 2])
    between = data.excitation_at(np.array([0.25]), -np.pi / 16)[0]
    expected = 0.25 * (data.excitation[1:3, 0] + data.excitation[1:3, 15]).sum(axis=0)
    assert np.allclose(between, expected)
    assert np.allclose(data.excitation_at(data.omega, 2 * np.pi - 1e-12), data.excitation[:, 0])
    low = data.excitation_at(np.array([0.0, 0.05]), 0.0)  # towards the hydrostatic limit
    assert np.allclose(low[0], data.hydrostatic_stiffness[:, 2])
    assert np.allclose(low[1], 0.5 * (low[0] + data.excitation[0, 0]))


def test_nothing_is_extrapolated(data, folder):
    with pytest.raises(DataError, match="above the highest frequency"):
        data.excitation_at(np.array([2.2]), 0.0)
    with pytest.raises(DataError, match="above the highest frequency"):
        data.radiation_at(np.array([2.2]))
    with pytest.raises(DataError, match="above the highest frequency"):
        data.mean_drift_at(np.array([2.2]), 0.0)
    half = synthetic.dataset(headings=np.arange(9) * np.pi / 8)
    half_data = read_bytes(synthetic.to_bytes(half, folder), "half.nc")
    half_data.excitation_at(np.array([1.0]), 1.0)
    with pytest.raises(DataError, match=r"202\.5 deg"):
        half_data.excitation_at(np.array([1.0]), np.radians(202.5))
    lone = read_bytes(synthetic.to_bytes(synthetic.dataset(headings=[0.3]), folder), "lone.nc")
    assert lone.excitation_at(np.array([1.0]), 0.3).shape == (1, 6)
    with pytest.raises(DataError, match="headings round the circle"):
        lone.excitation_at(np.array([1.0]), 0.4)


def test_radiation_passes_the_nodes_and_is_near_the_law_between(data):
    added_mass, damping = data.radiation_at(data.omega)
    assert np.allclose(added_mass, data.added_mass)
    assert np.allclose(damping, data.damping)
    middle = np.array([0.05, 0.55, 1.05])
    _, damping = data.radiation_at(middle)
    assert np.abs(damping - synthetic.damping(middle)).max() < 0.01 * data.damping.max()
    assert np.allclose(data.radiation_at(np.array([0.0]))[0][0], data.added_mass_zero)


def test_mean_drift_is_linear_and_fades_to_zero(data):
    drift = data.mean_drift_at(np.array([[0.0, 0.05], [0.1, 0.55]]), np.pi / 2)
    assert drift.shape == (2, 2, 6)
    assert drift[..., 1] == pytest.approx(5e4 * np.array([[0.0, 0.05], [0.1, 0.55]]))


# --- another point


def test_moved_to_keeps_power_and_returns(data):
    point = np.array([3.0, -2.0, 5.0])
    moved = data.moved_to(point)
    arm = point - data.reference_point
    rng = np.random.default_rng(3)
    new = rng.normal(size=6)
    old = new.copy()
    old[:3] -= np.cross(new[3:], arm)  # velocity of the old point
    assert np.allclose(transport(arm) @ new, old)
    assert np.allclose(new @ moved.damping @ new, old @ data.damping @ old)
    assert np.allclose(moved.excitation @ new, data.excitation @ old)
    assert np.allclose(new @ moved.hydrostatic_stiffness @ new, old @ data.hydrostatic_stiffness @ old)
    moment = data.excitation[..., 3:] - np.cross(arm, data.excitation[..., :3])
    assert np.allclose(moved.excitation[..., 3:], moment)
    assert np.allclose(
        moved.mean_drift[..., 5],
        data.mean_drift[..., 5] - arm[0] * data.mean_drift[..., 1] + arm[1] * data.mean_drift[..., 0],
    )
    assert not moved.mean_drift[..., 2:5].any()
    back = moved.moved_to(data.reference_point)
    assert np.allclose(back.added_mass, data.added_mass)
    assert np.allclose(back.excitation, data.excitation)
    assert data.moved_to(data.reference_point) is data


def test_data_of_the_wrong_shape_or_order_are_refused(data):
    with pytest.raises(DataError, match="added_mass has shape"):
        dataclasses.replace(data, added_mass=data.added_mass[:3])
    with pytest.raises(DataError, match="rise"):
        dataclasses.replace(data, omega=data.omega[::-1])


def test_qtf_is_bilinear_and_must_be_hermitian():
    omega = np.array([0.4, 0.6, 1.0])
    m, n = np.meshgrid(omega, omega, indexing="ij")
    table = (m + n + 1j * (m - n))[None, :, :, None] * np.arange(1.0, 7.0)
    qtf = QTF(omega, np.array([0.0]), table)
    value = qtf.at(np.array([0.5, 0.9]), np.array([0.7, 1.0]), 0.0)
    assert np.allclose(value[:, 0], [1.2 - 0.2j, 1.9 - 0.1j])
    with pytest.raises(DataError, match="above the highest"):
        qtf.at(np.array([1.1]), np.array([0.5]), 0.0)
    with pytest.raises(DataError, match="Hermitian"):
        QTF(omega, np.array([0.0]), table + 1j)


# --- where files come from


def test_file_source_reads_relative_paths_and_can_be_confined(source, folder, data):
    payload = synthetic.to_bytes(source, folder)
    inner = folder / "case"
    inner.mkdir(exist_ok=True)
    (inner / "hull.nc").write_bytes(payload)
    (folder / "outside.nc").write_bytes(payload)
    (inner / "link.nc").unlink(missing_ok=True)
    (inner / "link.nc").symlink_to(folder / "outside.nc")
    assert np.array_equal(FileSource(inner).open("hull.nc").omega, data.omega)
    assert FileSource(inner).open("../outside.nc").name == "outside.nc"
    for reference in (
        "../outside.nc",
        str(folder / "outside.nc"),
        "link.nc",
        "a/../../outside.nc",
        "C:\\x.nc",
        "..\\x.nc",
    ):
        with pytest.raises(DataError, match="case's folder"):
            FileSource(inner, confined=True).open(reference)
    for reference in ("missing.nc", ".", "a\0b", "x" * 5000):
        for confined in (False, True):
            with pytest.raises(DataError):
                FileSource(inner, confined).open(reference)


def test_reading_data_loads_no_compiled_kernels():
    code = "import sys, solver.vessel.data; print([m for m in ('numba', 'xarray', 'scipy') if m in sys.modules])"
    assert (
        subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == "[]"
    )


def test_a_file_that_capytaine_itself_writes(tmp_path):
    """Long waves accelerate the displaced and the added mass of a small box: +i in this convention."""
    cpt = pytest.importorskip("capytaine")
    import xarray as xr

    cpt.set_logging("ERROR")
    mesh = cpt.mesh_parallelepiped(size=(20, 10, 4), center=(0, 0, -2), resolution=(6, 4, 3), missing_sides={"top"})
    body = cpt.FloatingBody(mesh, cpt.rigid_body_dofs(rotation_center=(0, 0, 1)), center_of_mass=(0, 0, 1), name="box")
    body.inertia_matrix = body.compute_rigid_body_inertia()
    body.hydrostatic_stiffness = body.compute_hydrostatic_stiffness(rho=1025.0, g=9.81)
    test = xr.Dataset(
        coords={"omega": [0.1, 0.5, np.inf], "wave_direction": [0.0, np.pi / 2], "radiating_dof": list(body.dofs),
                "water_depth": [np.inf], "rho": 1025.0, "g": 9.81}
    )  # fmt: skip
    cpt.export_dataset(
        tmp_path / "box.nc", cpt.BEMSolver().fill_dataset(test, body, hydrostatics=True, progress_bar=False)
    )
    data = read_bytes((tmp_path / "box.nc").read_bytes(), "box.nc")
    assert data.added_mass_infinite is not None
    assert data.displaced_volume == pytest.approx(800.0)
    assert np.array_equal(data.reference_point, [0, 0, 1])
    second_moment = 200 * 10**2 / 12 * (1 - 1 / 4**2)  # Capytaine sums y² at the middle of its four panels
    stiffness = 1025 * 9.81 * np.array([200, second_moment - 800 * 3])
    assert np.diag(data.hydrostatic_stiffness)[2:4] == pytest.approx(stiffness, rel=1e-9)
    surge, _, heave = data.excitation[0, 0, :3]
    assert heave.real == pytest.approx(1025 * 9.81 * 200, rel=0.05)
    accelerated = 1025 * 800 + data.added_mass[0, 0, 0]
    assert surge.imag == pytest.approx(0.1**2 * accelerated, rel=0.05)
