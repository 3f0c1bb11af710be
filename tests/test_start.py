"""What a start does not load: the parts of SciPy, xarray and pandas that only some cases need take longer than a case."""

import subprocess
import sys
from pathlib import Path

import pytest

from tests.vessel import synthetic

HEAVY = (  # numba itself looks at the version of SciPy and, with the first compiled function, loads scipy.linalg
    "scipy.linalg", "scipy.sparse", "scipy.optimize", "scipy.interpolate", "scipy.special", "scipy.integrate",
    "scipy.io", "xarray", "pandas", "h5netcdf",
)  # fmt: skip


def loaded(code: str, *heavy: str) -> str:
    """The packages of `heavy` that a fresh interpreter holds after the code, as text."""
    code = f"import sys\n{code}\nprint(*[name for name in {heavy!r} if name in sys.modules])"
    root = Path(__file__).parents[1]
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=root)
    return done.stdout.strip()


@pytest.mark.parametrize(
    "module", ["solver.run", "solver.waves.spectra", "solver.waves.kinematics", "solver.modes.solve"]
)
def test_the_solver_starts_without_scipy_and_xarray(module):
    assert loaded(f"import {module}", *HEAVY, "h5py") == ""


def test_a_file_of_hydrodynamic_data_is_read_and_used_without_them_too(tmp_path):
    path = tmp_path / "hull.nc"
    path.write_bytes(synthetic.to_bytes(synthetic.dataset(), tmp_path))
    code = f"""
from solver.vessel.data import read_bytes
from solver.vessel.radiation import retardation
data = read_bytes(open({str(path)!r}, "rb").read(), "hull.nc")
data.radiation_at(data.omega)
retardation(data)
"""
    assert loaded(code, *HEAVY, "numba", "scipy") == ""
