"""Files that today's Capytaine writes, NetCDF and WAMIT's, read without any conversion: they are one body."""

import numpy as np
import pytest

from solver.case.vessel import WamitFiles
from solver.vessel.data import FileSource
from solver.vessel.quality import quality

capytaine = pytest.importorskip("capytaine", reason="the extra `bem` (Capytaine 3) is not installed")
pytestmark = pytest.mark.slow
CENTRE = (0.0, 0.0, -2.0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A floating hemisphere of radius 5 m, solved at four frequencies and both limits, four headings."""
    from capytaine.io.wamit import export_to_wamit

    base = tmp_path_factory.mktemp("capytaine")
    mesh = capytaine.mesh_sphere(radius=5.0, resolution=(20, 24)).immersed_part()
    dofs = capytaine.rigid_body_dofs(rotation_center=(0.0, 0.0, 0.0))
    body = capytaine.FloatingBody(mesh=mesh, dofs=dofs, center_of_mass=CENTRE)
    hydrostatics = body.compute_hydrostatics(rho=1025.0, g=9.81)
    omega, headings = np.array([0.4, 0.8, 1.2, 1.6]), np.radians([0.0, 90.0, 180.0, 270.0])
    water = {"water_depth": np.inf, "rho": 1025.0, "g": 9.81}
    problems = [
        capytaine.RadiationProblem(body=body, radiating_dof=dof, omega=w, **water)
        for w in (0.0, *omega, np.inf)
        for dof in body.dofs
    ]
    problems += [
        capytaine.DiffractionProblem(body=body, wave_direction=b, omega=w, **water) for w in omega for b in headings
    ]
    results = capytaine.BEMSolver().solve_all(problems, progress_bar=False)
    dataset = capytaine.assemble_dataset(results)
    dataset = dataset.merge({"hydrostatic_stiffness": hydrostatics["hydrostatic_stiffness"]})
    capytaine.export_dataset(base / "direct.nc", dataset)
    if "excitation_force" not in dataset:
        dataset["excitation_force"] = dataset["Froude_Krylov_force"] + dataset["diffraction_force"]
    export_to_wamit(dataset, str(base / "listed"), exports=("1", "3", "hst"))
    return base


@pytest.fixture(scope="module")
def direct(folder):
    return FileSource(folder).open("direct.nc")


def test_the_netcdf_file_needs_no_conversion(direct):
    assert np.allclose(direct.omega, [0.4, 0.8, 1.2, 1.6])
    assert np.allclose(np.degrees(direct.headings), [0, 90, 180, 270])
    assert direct.added_mass_zero is not None
    assert direct.added_mass_infinite is not None
    half = 0.5 * (0.5 * 4 / 3 * np.pi * 5**3 * 1025)  # half the added mass of a sphere in unbounded water
    assert direct.added_mass_infinite[2, 2] == pytest.approx(half, rel=0.04)  # coarse panels
    assert direct.hydrostatic_stiffness[2, 2] == pytest.approx(1025 * 9.81 * np.pi * 25, rel=0.04)  # a polygon
    checks = {check.name: check for check in quality(direct)}
    assert checks["haskind"].state == "ok"
    assert checks["haskind"].value < 0.03
    assert checks["damping"].state == "ok"


def test_its_wamit_files_say_the_same(folder, direct):
    """Phase, headings, powers of ULEN = 1, the limits -1 and 0: two writers of one result."""
    said = WamitFiles(length=1.0, density=1025.0, gravity=9.81, first_column="periods", centre_of_mass=CENTRE)
    listed = FileSource(folder).open("listed", said)
    assert np.allclose(listed.omega, direct.omega, rtol=1e-6)
    assert np.allclose(listed.headings, direct.headings)
    for field in (
        "added_mass",
        "damping",
        "excitation",
        "added_mass_zero",
        "added_mass_infinite",
        "hydrostatic_stiffness",
    ):
        ours, theirs = getattr(listed, field), getattr(direct, field)
        if field in ("added_mass", "damping", "added_mass_zero", "added_mass_infinite"):
            theirs = theirs.swapaxes(-1, -2)  # the exporter writes the motion first; equal but for the panels
        assert np.allclose(ours, theirs, rtol=1e-5, atol=1e-5 * np.abs(theirs).max()), field
