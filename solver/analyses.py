"""The analyses of one case in their order: what needs what, and which failure stops which."""

from __future__ import annotations

import numpy as np

from .case import DOF, Case
from .case.analysis import FrequencyDomain
from .frequency_domain.linearise import DragState, linearise
from .frequency_domain.same_waves import SeedWaves, same_waves
from .frequency_domain.solve import FrequencyResult, solve_frequency_domain
from .model.build import Model
from .model.linear import line_geometry
from .model.vessel import VesselModel
from .modes.assemble import assemble
from .modes.equivalent import equivalent_coefficients
from .modes.solve import line_shapes, solve_modes
from .outcome import NotConverged, numerical
from .results.part import OnProgress, Progress
from .results.solved import ModesResult
from .statics.newton import vessel_coupling
from .statics.solve import StaticState
from .time_domain.block import timing
from .time_domain.sea import VesselLoads, components, low_border

Array = np.ndarray


def linear_analysis(
    model: Model, static: StaticState, asked: tuple[str, ...], tell: OnProgress, failures: dict[str, str]
) -> FrequencyResult | None:
    """The frequency domain when asked for, or when the modes want its damping."""
    wanted = "frequency_domain" in asked
    moves = bool(model.case.environment.seastates)
    if not wanted and not ("modes" in asked and moves and _linearisable(model.case)):
        return None
    spec = model.case.analyses.frequency_domain or FrequencyDomain()

    def follow(iteration: int, change: float) -> None:
        done = min(max(np.log10(max(change, 1e-12)) / np.log10(spec.tolerance), 0.0), 1.0)
        tell(Progress(0.1 + 0.6 * float(done), f"frequency domain, iteration {iteration}, change {change:.1e}"))

    try:
        with numerical("frequency_domain"):
            return solve_frequency_domain(model, static, spec, follow)
    except NotConverged as failure:
        if wanted:
            failures["frequency_domain"] = str(failure)
        if "modes" in asked:
            failures["modes"] = f"the damping of the lines is not known: {failure}"
        return None


def _linearisable(case: Case) -> bool:
    return not (case.environment.regular and case.environment.random)


def modes_analysis(
    model: Model, static: StaticState, frequency: FrequencyResult | None, asked: tuple[str, ...], tell: OnProgress,
    failures: dict[str, str],
) -> ModesResult | None:  # fmt: skip
    spec = model.case.analyses.modes
    if spec is None or "modes" in failures:
        return None
    tell(Progress(0.75, "modes"))
    try:
        with numerical("modes"):
            return natural_modes(model, static, frequency, spec.count)
    except NotConverged as failure:
        failures["modes"] = str(failure)
        return None


def natural_modes(model: Model, static: StaticState, frequency: FrequencyResult | None, count: int) -> ModesResult:
    """Modes about the static position, with the drag of the frequency domain or, without one, of the current alone."""
    if frequency is not None:
        static, geometries, damping = frequency.static, frequency.geometries, frequency.linear.damping
        quadratic = frequency.linear.vessel
    else:
        geometries = [line_geometry(line, x) for line, x in zip(static.lines, static.state.shapes, strict=True)]
        still = DragState([np.zeros((g.x.shape[0], 6)) for g in geometries], np.zeros(6))
        linear = linearise(geometries, still, np.zeros(6), True, True)
        damping, quadratic = linear.damping, np.zeros(6)
    body, position = static.body, static.position
    couplings = [vessel_coupling(line, body, position) if body else np.zeros((6, 6)) for line in static.lines]
    stiffness, geometric = None, np.zeros((6, 6))
    if body is not None:
        for line, force in zip(static.lines, static.state.end_forces, strict=True):
            for row, end in enumerate(line.ends):
                if end.kind == "fairlead" and end.arm is not None:
                    at_end = force[3 * row : 3 * row + 3]
                    geometric = geometric + line.multiplicity * body.geometric(position, end.arm, at_end)
        stiffness = body.stiffness(position) + geometric
    system = assemble(geometries, damping, couplings, stiffness)
    vessel = None
    if model.vessel is not None:
        vessel = _vessel_matrices(model.vessel, float(position[5]), quadratic)
    modes = solve_modes(system, vessel, count)
    nodes = [line.nodes for line in static.lines]
    by_mode = [line_shapes(system, mode, couplings, nodes) for mode in modes]
    shapes = [np.stack([one[i] for one in by_mode]) for i in range(len(nodes))]
    equivalent = equivalent_coefficients(geometries, damping, couplings, geometric) if body is not None else None
    return ModesResult(modes, shapes, equivalent, system.asymmetry)


def _vessel_matrices(vessel: VesselModel, yaw: float, quadratic: Array):  # type: ignore[no-untyped-def]
    def at(omega: float) -> tuple[Array, Array]:
        dynamic = vessel.dynamic(np.array([omega]), yaw, quadratic)[0]
        return -dynamic.real / omega**2, dynamic.imag / omega

    return at


def seeds_in_linear_system(
    model: Model, static: StaticState, frequency: FrequencyResult
) -> dict[str, dict[str, float]]:
    """σ of the linear system under the very waves of the seeds that the time domain marches."""
    spec = model.case.analyses.time_domain
    assert spec is not None
    duration = timing(spec).duration
    waves = components(model, spec, duration)
    assert waves is not None
    loads = VesselLoads(model, waves, float(static.position[5]), float(spec.step))
    amplitudes = [
        waves.amplitudes(seed, spec.amplitudes == "random")
        for seed in range(spec.first_seed, spec.first_seed + spec.seeds)
    ]
    differences = np.array([loads.difference(one)[1:] for one in amplitudes])
    found = same_waves(
        model, frequency, SeedWaves(waves.omega, waves.step, np.array(amplitudes), differences, low_border(model))
    )
    return {band: dict(zip(DOF, (float(value) for value in found[band]), strict=True)) for band in ("wf", "lf")}
