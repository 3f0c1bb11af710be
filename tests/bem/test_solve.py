"""Boundary elements: our equations against Capytaine's own solver, symmetry against none, identities."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from solver.bem import parse_job, prepare
from solver.bem.body import folded
from solver.bem.drift import absorbed, highest_order, kochin, mean_drift
from solver.bem.green import _as_capytaine, solve_symmetric
from solver.bem.job import wet
from solver.bem.quality import edges_of
from solver.bem.solve import FrequencySolver, Solved, Wet, generalized_normals
from solver.bem.symmetry import Fundamental
from solver.waves.dispersion import wave_number

from .shapes import hemisphere, need_capytaine

need_capytaine()
RHO, G = 1000.0, 9.81
SHIP = {"kind": "ship", "length": 100, "breadth": 20, "draft": 8, "bow": 20, "stern": 15}
HEADINGS = np.array([0.3, 2.0])


def shape(hull: dict[str, Any], depth: float, size: float = 6.0, centre: tuple[float, float, float] = (0, 0, 3)) -> Wet:
    data: dict[str, Any] = {
        "geometry": {"hull": hull, "panel_size": size},
        "water": {"density": RHO, "gravity": G} | ({} if math.isinf(depth) else {"depth": depth}),
        "body": {"centre_of_gravity": centre, "radii_of_gyration": [1, 1, 1]},
    }
    job = parse_job(data, compute=False)
    return wet(job, prepare(job, lambda _: (b"", "")))


def nothing(share: float, words: str) -> None:
    assert 0 <= share <= 1
    assert words


@pytest.mark.parametrize("depth", [math.inf, 30.0])
@pytest.mark.parametrize("with_lid", [True, False])
def test_against_capytaines_own_solver(depth: float, with_lid: bool) -> None:
    """The same panels, sources and Green function; ours without the closure of the flux, which Capytaine lacks."""
    import capytaine as cpt

    whole = shape(SHIP, depth, 10.0)
    ours = Wet(whole.hull, whole.lid if with_lid else None, whole.planes, whole.centre, depth, RHO, G)
    solver = FrequencySolver(ours, HEADINGS)
    solver._closure = np.zeros(ours.hull.count)
    found = solver.solve(0.8, nothing)

    def mesh(part: Any) -> Any:
        panels = Fundamental(part, ours.planes).whole()
        return cpt.Mesh(panels.vertices, _as_capytaine(panels))

    body = cpt.FloatingBody(
        mesh=mesh(ours.hull),
        lid_mesh=mesh(ours.lid) if with_lid else None,
        dofs=cpt.rigid_body_dofs(rotation_center=(0, 0, 3)),
        center_of_mass=(0, 0, 3),
    )
    common = {"body": body, "omega": 0.8, "rho": RHO, "g": G, "water_depth": depth}
    problems = [cpt.RadiationProblem(radiating_dof=dof, **common) for dof in body.dofs]
    problems += [cpt.DiffractionProblem(wave_direction=beta, **common) for beta in HEADINGS]
    theirs = [cpt.BEMSolver(method="indirect").solve(p, _check_wavelength=False) for p in problems]
    assert found.froude_krylov is not None
    assert found.diffraction is not None
    assert found.waves is not None
    pairs = {
        "added mass": (found.added_mass, [[r.added_masses[i] for r in theirs[:6]] for i in body.dofs]),
        "damping": (found.damping, [[r.radiation_dampings[i] for r in theirs[:6]] for i in body.dofs]),
        "diffraction": (found.diffraction, [[r.forces[i] for i in body.dofs] for r in theirs[6:]]),
        "Froude-Krylov": (found.froude_krylov, [list(_froude_krylov(p).values()) for p in problems[6:]]),
    }
    for name, (mine, other) in pairs.items():
        assert mine == pytest.approx(np.array(other), abs=2e-5 * np.abs(other).max()), name
    theta = np.linspace(0, 6, 7)
    order = (found.waves.shape[0] - 1) // 2
    mine = found.waves.T @ np.exp(1j * np.outer(np.arange(-order, order + 1), theta))
    other = np.array([cpt.post_pro.kochin.compute_kochin(r, theta) for r in theirs])
    assert mine == pytest.approx(other, abs=2e-5 * np.abs(other).max())


def _froude_krylov(problem: Any) -> dict[str, complex]:
    from capytaine.bem.airy_waves import froude_krylov_force

    found: dict[str, complex] = froude_krylov_force(problem)
    return found


def test_symmetry_saves_work_and_changes_nothing() -> None:
    barge = {"kind": "barge", "length": 80, "breadth": 24, "draft": 8}
    with_planes = shape(barge, math.inf, 8.0)
    assert with_planes.planes == ("x", "y")
    lid = Fundamental(with_planes.lid, with_planes.planes).whole()  # type: ignore[arg-type]
    hull = Fundamental(with_planes.hull, with_planes.planes).whole()
    without = Wet(hull, lid, (), with_planes.centre, math.inf, RHO, G)
    fast, slow = (FrequencySolver(each, HEADINGS).solve(1.1, nothing) for each in (with_planes, without))
    for name in ("added_mass", "damping", "diffraction", "froude_krylov", "waves"):
        mine, other = getattr(fast, name), getattr(slow, name)
        assert mine == pytest.approx(other, abs=1e-9 * np.abs(other).max()), name


def test_block_solution_is_the_dense_one() -> None:
    random = np.random.default_rng(1)
    for copies in (1, 2, 4):
        n = 5
        s, k = random.normal(size=(2, copies, n, n)) + 1j * random.normal(size=(2, copies, n, n))
        k[0] += 20 * np.eye(n)

        def dense(blocks: np.ndarray, copies: int = copies) -> np.ndarray:
            return np.block([[blocks[i ^ j] for j in range(copies)] for i in range(copies)])

        right = random.normal(size=(copies * n, 3)).astype(complex)
        strength, potential = solve_symmetric(s, k, right, lambda share: None)
        assert dense(k) @ strength == pytest.approx(right)
        assert potential == pytest.approx(dense(s) @ strength)


def test_headings_are_mirrored_rather_than_solved() -> None:
    headings = np.radians(np.arange(0, 360, 15))
    for planes, count in (((), 24), (("y",), 13), (("x",), 13), (("x", "y"), 7)):
        assert folded(headings, planes)[0].size == count
    barge = shape({"kind": "barge", "length": 80, "breadth": 24, "draft": 8}, math.inf, 8.0)
    asked = np.radians([20.0, 160.0, 200.0, 340.0])
    solved, places = folded(asked, ("x", "y"))
    few = FrequencySolver(barge, solved).solve(0.9, nothing)
    all_of_them = FrequencySolver(barge, asked).solve(0.9, nothing)
    assert few.diffraction is not None
    assert all_of_them.diffraction is not None
    for index, (place, signs) in enumerate(places):
        mirrored = few.diffraction[place] * signs
        assert mirrored == pytest.approx(all_of_them.diffraction[index], abs=1e-9 * np.abs(mirrored).max())


def test_irregular_frequencies_are_gone_with_the_lid() -> None:
    """A round column resonates inside at ω² = g k coth(kT), k = 2.405 / R."""
    column = {"kind": "spar", "profile": [{"depth": 0, "diameter": 20}, {"depth": 10, "diameter": 20}]}
    with_lid = shape(column, math.inf, 2.5, (0, 0, 0))
    k = 2.404826 / 10
    irregular = math.sqrt(G * k / math.tanh(k * 10))
    bare = Wet(with_lid.hull, None, with_lid.planes, with_lid.centre, math.inf, RHO, G)
    omegas = irregular * np.array([0.98, 0.99, 1.0, 1.01, 1.02])
    heave = {}
    for name, each in (("bare", bare), ("lid", with_lid)):
        solver = FrequencySolver(each, np.zeros(1))
        values = np.array([solver.solve(float(omega), nothing).added_mass[2, 2] for omega in omegas])
        heave[name] = np.abs(np.diff(values, 2)).max() / values.mean()
    assert with_lid.lid_from < omegas[0]
    assert heave["bare"] > 0.03
    assert heave["lid"] < 1e-3


@pytest.mark.parametrize("depth", [math.inf, 3.0])
def test_energy_and_haskind(depth: float) -> None:
    """Damping from the waves sent out, excitation from radiation, and no power lost by a fixed body."""
    mesh = hemisphere(9)
    wet_one = Wet(mesh, None, (), np.zeros(3), depth, RHO, G)
    omega, beta = 2.6, np.array([0.0, 0.7])
    found = FrequencySolver(wet_one, beta).solve(omega, nothing)
    k = float(wave_number(omega, depth, G))
    assert found.waves is not None
    radiated, scattered = found.waves[:, :6], found.waves[:, 6:]
    gap, sent = absorbed(scattered, beta, omega, k, depth, RHO, G)
    assert np.abs(gap / sent).max() < 0.01
    # a body that moves with amplitude 1 loses ω² B / 2 = what it sends out; phase speed ω / k
    for dof in (0, 2):
        sent = absorbed(radiated[:, [dof]], beta[:1], omega, k, depth, RHO, G)[1]
        assert omega * found.damping[dof, dof] * k / 2 == pytest.approx(sent[0], rel=0.02)


def test_the_kochin_series_is_the_integral() -> None:
    random = np.random.default_rng(2)
    points = np.column_stack([random.uniform(-3, 3, (50, 2)), random.uniform(-2, 0, 50)])
    strength = random.normal(size=(50, 2)) + 1j * random.normal(size=(50, 2))
    k = 1.3
    order = highest_order(float(np.hypot(points[:, 0], points[:, 1]).max()), k)
    series = kochin(points, strength, k, math.inf, order)
    theta = np.linspace(0, 2 * math.pi, 9)
    phase = np.exp(-1j * k * (np.outer(np.cos(theta), points[:, 0]) + np.outer(np.sin(theta), points[:, 1])))
    direct = phase @ (strength * np.exp(k * points[:, 2])[:, None]) / (4 * math.pi)
    summed = np.exp(1j * np.outer(theta, np.arange(-order, order + 1))) @ series
    assert summed == pytest.approx(direct, abs=1e-8 * np.abs(direct).max())


def test_drift_turns_with_the_body_and_the_waves() -> None:
    random = np.random.default_rng(3)
    h = random.normal(size=(11, 1)) + 1j * random.normal(size=(11, 1))
    m, angle = np.arange(-5, 6)[:, None], 0.4
    still = mean_drift(h, np.array([0.2]), 1.0, 0.1, math.inf, RHO, G)[0]
    turned = mean_drift(h * np.exp(-1j * m * angle), np.array([0.2 + angle]), 1.0, 0.1, math.inf, RHO, G)[0]
    c, s = math.cos(angle), math.sin(angle)
    assert turned == pytest.approx([c * still[0] - s * still[1], s * still[0] + c * still[1], still[2]])


def test_finite_depth_tends_to_infinite_depth() -> None:
    column = {"kind": "spar", "profile": [{"depth": 0, "diameter": 20}, {"depth": 10, "diameter": 20}]}
    found: list[Solved] = []
    for depth in (math.inf, 400.0):
        found.append(FrequencySolver(shape(column, depth, 4.0), np.zeros(1)).solve(0.7, nothing))
    for name in ("added_mass", "damping", "diffraction"):
        a, b = (getattr(each, name) for each in found)
        assert a == pytest.approx(b, abs=1e-3 * np.abs(a).max()), name


def test_infinite_frequency_lies_below_zero_frequency_in_surge_and_both_are_symmetric() -> None:
    solver = FrequencySolver(shape(SHIP, math.inf), HEADINGS)
    low, high = (solver.solve(omega, nothing).added_mass for omega in (0.0, math.inf))
    assert high[0, 0] < low[0, 0]
    for matrix in (low, high):
        scale = np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))
        assert np.abs((matrix - matrix.T) / scale).max() < 0.02
        assert np.all(np.linalg.eigvalsh(0.5 * (matrix + matrix.T)) > 0)


def test_generalized_normals_of_a_closed_hull_sum_to_its_water_plane() -> None:
    mesh = hemisphere(10)
    sums = (generalized_normals(mesh, np.array([0.2, 0.1, 0.0])) * mesh.areas[:, None]).sum(axis=0)
    area = mesh.water_plane()[0]
    assert sums[:3] == pytest.approx([0, 0, -area], abs=1e-9)
    assert sums[3:5] == pytest.approx([-area * -0.1, -area * 0.2], abs=2e-2)
    assert edges_of(mesh).open == 0
