"""Speed beside OpenRAFT: VolturnUS-S with dynamic lines in the frequency domain, seconds of one load case, one thread.

    pip install openraft                  (an environment of its own is best: --raft-python names its interpreter)
    python benchmarks/against_openraft.py FOLDER [--raft-python PYTHON] [--repeat 3]

FOLDER holds the public WAMIT and MoorDyn files of the UMaine VolturnUS-S (umainesemi.1, .3, .hst and
umainesemi_MoorDyn.dat, from IEAWindTask37/IEA-15-240-RWT). Both codes get the platform with tower and turbine as one rigid
body, its potential-flow data without drag of the hull, three chains with line dynamics (OpenRAFT's moorMod 2), and 40
frequencies. A load case is statics, linearised drag of the lines until it settles, and statistics; building the models
and reading the data is not timed. Each code runs in a process of its own, in turn; medians of processor time are shown.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("MPLBACKEND", "Agg")

SEAS = ((4.0, 9.0), (6.0, 12.0), (9.0, 14.0), (12.0, 16.0))  # Hs m, Tp s
EXAMPLE = Path(__file__).parents[1] / "examples" / "volturnus-s.yaml"
MASS, CG, ROLL, YAW = 2.0108e7, -2.38, 4.40e10, 2.40e10  # as in the example: platform, tower and turbine: kg, m, kg m2
LEAST, COUNT = 0.005, 40  # Hz, frequencies
MEMORY = 6 * 2**30
STEM, DECK = "umainesemi", "umainesemi_MoorDyn.dat"
DOFS = ("surge", "sway", "heave", "roll", "pitch", "yaw")


def ours(folder: Path) -> list[dict[str, Any]]:
    """Slowdrift's load cases: seconds, and σ of motion [m, degrees] and of tension at the fairleads [kN]."""
    import yaml

    from solver.case import parse_case
    from solver.frequency_domain.solve import solve_frequency_domain
    from solver.model.build import build
    from solver.run import run, warm_up
    from solver.statics.solve import solve_statics
    from solver.vessel.data import FileSource

    warm_up()
    step = 2 * math.pi * LEAST
    data = yaml.safe_load(EXAMPLE.read_text())
    del data["vessel"]["damping"]
    data["vessel"] |= {"mean_drift": "exclude"}
    data["vessel"]["hydrodynamics"] |= {"data": STEM, "drift": "none"}
    wave = {"from": 0.5 * step, "to": (COUNT + 0.5) * step, "step": step}
    low = {"to": 0.5 * step, "step": 0.25 * step}
    data["analyses"] = {"frequency_domain": {"wave": wave, "low": low, "tolerance": 1e-3}}
    found = []
    for hs, tp in SEAS:
        data["environment"]["seastates"] = _sea(hs, tp)
        case = parse_case(data)
        model = build(case, FileSource(folder))
        spec = case.analyses.frequency_domain
        assert spec is not None
        started = time.process_time()
        result = solve_frequency_domain(model, solve_statics(model), spec)
        seconds = time.process_time() - started
        summary = run(case, FileSource(folder)).summary["frequency_domain"]
        sigma = {dof: summary["vessel_std"]["wf"][dof] * (1 if k < 3 else 180 / math.pi) for k, dof in enumerate(DOFS)}
        tension = [line["tension_std"]["wf"][-1] / 1e3 for line in summary["lines"].values()]
        found.append({"seconds": seconds, "iterations": result.iterations, "sigma": sigma, "tension": tension})
    return found


def _sea(hs: float, tp: float) -> list[dict[str, Any]]:
    return [{"spectrum": "jonswap", "hs": hs, "tp": tp, "gamma": 3.3, "direction": "0 deg"}]


def _design(folder: Path) -> dict[str, Any]:
    """The same body for OpenRAFT: members give buoyancy only, a point inertia the mass."""
    shell = {"type": "rigid", "shape": "circ", "gamma": 0.0, "potMod": True, "t": 0.001, "rho_shell": 1.0, "Cd": 0.0,
             "Ca": 0.0, "CdEnd": 0.0, "CaEnd": 0.0, "dlsMax": 5.0}  # fmt: skip
    around = {"heading": [60, 180, 300]}
    members = [
        {**shell, "name": "centre", "rA": [0, 0, -20], "rB": [0, 0, 15], "stations": [0, 35], "d": 10.0},
        {**shell, **around, "name": "outer", "rA": [51.75, 0, -20], "rB": [51.75, 0, 15], "stations": [0, 35], "d": 12.5},
        {**shell, **around, "name": "pontoon", "shape": "rect", "rA": [5, 0, -16.5], "rB": [45.5, 0, -16.5],
         "stations": [0, 40.5], "d": [12.4, 7.48], "Cd": [0.0, 0.0], "Ca": [0.0, 0.0]},
    ]  # fmt: skip
    keys = ["wind_speed", "wind_heading", "turbulence", "turbine_status", "yaw_misalign", "wave_spectrum", "wave_period",
            "wave_height", "wave_heading", "current_speed", "current_heading"]  # fmt: skip
    seas = [[0, 0, 0, "parked", 0, "JONSWAP", tp, hs, 0, 0, 0] for hs, tp in SEAS]
    return {
        "type": "input file for RAFT", "name": "VolturnUS-S",
        "settings": {"min_freq": LEAST, "max_freq": LEAST * COUNT, "XiStart": 0, "nIter": 15},
        "site": {"water_depth": 200, "rho_water": 1025.0, "g": 9.80665},
        "cases": {"keys": keys, "data": seas},
        "platform": {
            "potModMaster": 3, "potFirstOrder": 1, "hydroPath": str(folder / STEM), "dlsMax": 5.0, "members": members,
            "additional_effects": [{"type": "point_inertia", "mass": MASS, "location": [0, 0, CG],
                               "moments_of_inertia": [ROLL, ROLL, YAW, 0, 0, 0]}],
        },
        "mooring": {"water_depth": 200, "moorMod": 2, "file": str(folder / DECK)},
    }  # fmt: skip


def theirs(folder: Path) -> list[dict[str, Any]]:
    """OpenRAFT's load cases, as `ours`."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    import raft

    with tempfile.TemporaryDirectory() as here:
        os.chdir(here)
        model = raft.Model(_design(folder))
        model.analyzeUnloaded()
        found: list[dict[str, Any]] = []
        whole = model.design["cases"]["data"]
        for sea in whole:
            model.design["cases"]["data"] = [sea]
            started = time.process_time()
            model.analyzeCases()
            seconds = time.process_time() - started
            metrics = model.results["case_metrics"][0][0]
            sigma = {dof: float(metrics[f"{dof}_std"]) for dof in DOFS}
            moor = [float(value) / 1e3 for value in metrics["Tmoor_std"]]
            found.append({"seconds": seconds, "sigma": sigma, "tension": moor})
        os.chdir("/")
    return found


def _in_process(python: str, which: str, folder: Path) -> list[dict[str, Any]]:
    """One code in a process of its own. Ends with a clear sentence where it cannot run."""
    command = [python, str(Path(__file__).resolve()), str(folder.resolve()), "--only", which]
    root = Path(__file__).resolve().parents[1]
    done = subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(root)}, check=False
    )
    if done.returncode:
        if "No module named 'raft'" in done.stderr:
            sys.exit("This comparison needs OpenRAFT, which Slowdrift itself does not: pip install openraft")
        sys.exit(f"{which} could not run: {(done.stderr.strip().splitlines() or ['no reason given'])[-1]}")
    return list(json.loads(done.stdout.strip().splitlines()[-1]))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("folder", type=Path, help="folder of the VolturnUS-S files")
    parser.add_argument("--raft-python", default=sys.executable, help="interpreter that has openraft")
    parser.add_argument("--repeat", type=int, default=3, help="runs of each; medians are shown")
    parser.add_argument("--only", choices=("ours", "theirs"), help=argparse.SUPPRESS)
    given = parser.parse_args()
    missing = [name for name in (f"{STEM}.1", f"{STEM}.3", f"{STEM}.hst", DECK) if not (given.folder / name).is_file()]
    if missing:
        sys.exit(f"{given.folder} lacks {', '.join(missing)}: see the head of this script for where they come from")
    if given.only:
        print(json.dumps((ours if given.only == "ours" else theirs)(given.folder.resolve())))
        return
    mine, other = [], []
    for _ in range(given.repeat):
        mine.append(_in_process(sys.executable, "ours", given.folder))
        other.append(_in_process(given.raft_python, "theirs", given.folder))
    print(f"{'Hs, Tp':>12} {'Slowdrift, s':>13} {'OpenRAFT, s':>12} {'ratio':>6}   σ surge m, heave m, pitch deg, "
          "tension kN: ours | theirs")  # fmt: skip
    for k, (hs, tp) in enumerate(SEAS):
        us, them = (statistics.median(run[k]["seconds"] for run in runs) for runs in (mine, other))
        shown = [
            " ".join(
                [*(f"{run['sigma'][dof]:.3f}" for dof in ("surge", "heave", "pitch")), f"{max(run['tension']):.1f}"]
            )
            for run in (mine[0][k], other[0][k])
        ]
        print(f"{hs:>5g} m {tp:>3g} s {us:>13.3f} {them:>12.2f} {them / us:>6.1f}   {' | '.join(shown)}")


if __name__ == "__main__":
    main()
