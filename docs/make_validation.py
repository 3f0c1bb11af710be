"""Writes docs/validation.md and its plots from real runs of the examples: `python docs/make_validation.py`.

Takes some minutes. `--seeds` and `--duration` shorten the time domain of the FPSO; `--keep FOLDER` keeps solved cases
between calls (it knows nothing of a changed solver: empty the folder then). Plots need the extra `docs`.
"""

from __future__ import annotations

import argparse
import platform
import sys
import textwrap
import tomllib
from collections.abc import Sequence
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))

import validation_lines as lines
import validation_runs as runs
import validation_tables as tables
from validation_runs import Runner, Study, mode


def page(study: Study) -> str:
    """The whole page."""
    parts = [_head(study), _riser(study), lines.section(), _fpso(study), _radiation(study), _differences(study)]
    return "\n\n".join(_filled(block) for part in parts for block in part.split("\n\n")) + "\n"


def _filled(block: str) -> str:
    """A paragraph in lines of even length; tables, headings and pictures as they are."""
    if block.startswith(("|", "#", "![")):
        return block
    if block.startswith("- "):
        return "\n".join(f"- {_wrapped(item, '  ')}" for item in f"\n{block}".split("\n- ")[1:])
    return _wrapped(block, "")


def _wrapped(text: str, indent: str) -> str:
    return textwrap.fill(
        " ".join(text.split()), 118, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False
    )


def version(summary: runs.Summary) -> str:
    """The solver's version; the source tree's where no package is installed."""
    found = str(summary["provenance"]["solver_version"])
    project = Path(__file__).parents[1] / "pyproject.toml"
    return tomllib.loads(project.read_text(encoding="utf-8"))["project"]["version"] if "unknown" in found else found


def _head(study: Study) -> str:
    found = study.fpso.summary
    time = found["time_domain"]
    seeds = found["provenance"]["seeds"]
    return f"""# Validation

Runs of the examples beside Low & Langley (Applied Ocean Research 28, 2006; "paper"), and beside an independent check:
other codes
and computations of the same cases. Written by `python docs/make_validation.py` from real runs; every number of
Slowdrift's is computed there, none is typed in.

Slowdrift {version(found)}; FPSO: seeds {seeds[0]} to {seeds[-1]}, step {time["time_step"]:g} s,
build-up {time["build_up"] / 60:.1f} min,
kept {time["duration"] / 60:.1f} min each; machine: {platform.machine()}. Times are in [performance.md](performance.md)
(paper, 2 GHz Pentium 4: 90 h for the time domain, 3 min for the frequency domain)."""


def _riser(study: Study) -> str:
    full = {case: study.riser[case, 1.0] for case in (1, 2)}
    gaps = {case: runs.gap(runs.amplitude(one), runs.half_range(one)) for case, one in full.items()}
    means = {case: 1e-3 * runs.half_range(one).mean() for case, one in full.items()}
    firsts = {case: runs.gap(runs.amplitude(one), runs.harmonic(one)) for case, one in full.items()}
    return f"""## Hanging riser

`examples/hanging-riser-case1.yaml` (top moved 10 m, 27 s) and `-case2.yaml` (fixed ends, waves 10 m high, 10 s).

### Statics (Table 2)

{tables.statics_table(full[1].summary)}

The end tension is the size of the reaction. "Catenary" has no bending and no stretch.

### Tension at the top end (Fig. 3)

{tables.range_table(study)}

Range over the steady part, kN. MoorDyn: RK4, 0.5 ms, bending on, in a run of this case. Digitised: the plot published
with
the paper's companion, reading error about 0.3 kN, its first seconds may hold the end of a ramp
(`docs/data`: source and licence). Its phase is arbitrary, so ours is
shifted
to the largest cross-correlation, and the rms difference is taken over its last whole periods.

![Top end tension of the riser over time](validation/riser-top-tension.png)

### Along the riser (Fig. 4)

Frequency against time domain at full amplitude, mean over the elements: {gaps[1]:.1f} % in case 1 and {gaps[2]:.1f} %
in case 2 of the
half-range (paper: 25 and 15 %; check: 24.5 and 12.2 %); {firsts[1]:.1f} and {firsts[2]:.1f} % of the first harmonic
(check: 11.7 and 0.8 %). A half-range
holds higher harmonics, which no linear method has; in case 2 the second harmonic equals the first at a tenth of the
amplitude,
so the half-range's gap does not fall steadily. The first harmonic's does in case 1.

![Dynamic tension along the riser](validation/riser-along.png)

{tables.gap_table(study)}

Means along the line; build-up at the smaller factors 864 and 800 s, since drag that small is slow to end a transient.
"Check" is an
independent lumped-mass computation in deep water. The half-range is {means[1]:.2f} and {means[2]:.2f} kN in the mean
(check: 2.39 and 1.97). Deep water matters: at a depth of 100 m a wave of 10 s still feels the bottom a little, and in
case 2 the mean half-range falls to 1.82 kN, the gap to 11.1 %; that to the first harmonic stays
below 1 %.{_finer(study, means[2])}"""


def _finer(study: Study, mean: float) -> str:
    if study.finer is None:
        return ""
    change = 100 * (1e-3 * runs.half_range(study.finer).mean() / mean - 1)
    return f" A step of 0.02 s, a tolerance of 1e-8 and a build-up of 600 s together change ours by {change:+.2f} %."


def _fpso(study: Study) -> str:
    found = study.fpso.summary
    change = [100 * (mode(found, n)["damping_lines"] - mode(study.no_low, n)["damping_lines"]) for n in tables.LABELS]
    surge = [100 * mode(one, "surge")["damping_lines"] for one in (found, study.no_low)]
    return f"""## Spread-moored FPSO

`examples/fpso-2000m.yaml`. The paper does not give its hull's data, so a box barge stands in for it
([barge.md](barge.md)): motion, drift and with them
tension differ from the paper's for that reason, and only the paper's trends and both domains' agreement are to be had.
"Check" is an independent linear model of the same barge and lines, whose drag is linearised by wave-frequency motion
alone, and whose
LF σ are rough.

### Spectra (Fig. 7)

Time domain smoothed over 0.005 rad/s, mean of the seeds.

![Spectra of vessel motion and of top tension](validation/fpso-spectra.png)

### Standard deviations (Table 6)

"Same waves" is the linear system under the very waves of the time domain's seeds, so that no sampling is left between
them.
"Vector" is `linearisation: vector`, the drag of both normal directions together; the others linearise each direction
alone, as
the paper does.

{tables.sigma_table(study.fpso)}

{tables.tension_table(study.fpso)}

The paper's tension is of one line, it does not say which. Check, WF: 364 to 441 kN at the top of the four, 358 to 440
at the bottom;
this hull pitches more than the paper's, and the fairleads are not the paper's either.

{tables.agreement_table(study.fpso)}

LF tension is reported, not banded: see [below](#what-differs-between-the-domains-and-why).

### Natural modes (Table 7)

{tables.modes_table(found)}

### Tension along a line (Fig. 8)

![Standard deviation of tension along two lines](validation/fpso-tension-along.png)

### Damping by the lines against drag coefficient and sea (Fig. 10)

Frequency domain, strips twice as wide as in the example.

![Damping by lines against drag coefficient and significant wave height](validation/fpso-damping.png)

{tables.sweep_table(study.drag, "C_D, Hs 15.7 m")}

{tables.sweep_shape(study.drag)}

{tables.sweep_table(study.sea, "Hs, m, C_D 1")}

{tables.sweep_shape(study.sea)}

As in the paper, damping rises with C_D with a falling slope, and rises with the sea.

### Without slow velocities in the drag

Surge damping goes from {surge[0]:.1f} to {surge[1]:.1f} % (paper: 31.1 to 30.4 %). Points lost in surge, sway and yaw:
{", ".join(f"{x:.2f}" for x in change)}.

### Fairleads that turn with the vessel

The paper's yaw period exists only with `fairlead_kinematics: linear`: {mode(found, "yaw")["period"]:.1f} s. With
`finite`, the pretension resists
rotation and it is {mode(study.finite, "yaw")["period"]:.1f} s (check: about 87 s). A designer wants `finite`:
`examples/fpso-2000m-design.yaml`.{_compression(study)}"""


def _compression(study: Study) -> str:
    if study.slack is None:
        return ""
    return f"""

### Lines that carry no compression

The example's wire says `compression: allowed`: the elements are springs that push as they pull, as the paper's are. By
default an element carries its Euler load at most, 113 N for this wire (theory.md, L17). Time domain, the same seeds:

{tables.compression_table(study.fpso.summary, study.slack.summary)}

The frequency domain is the same for both: in statics no element is slack. A line that turns taut again pulls harder
than one that had pushed instead, so the largest forces rise and the least one vanishes; σ hardly changes."""


def _radiation(study: Study) -> str:
    follows = study.scan["follows"]
    periods = "/".join(f"{mode(follows, n)['period']:.1f}" for n in tables.LABELS)
    damping = "/".join(f"{100 * mode(follows, n)['damping_lines']:.1f}" for n in tables.LABELS)
    return f"""## Radiation at one constant frequency

The paper takes added mass and radiation damping at one frequency. For this barge (surge / sway / yaw; WF σ by motion):

{tables.scan_table(study.scan)}

No one frequency gives the check's numbers: the yaw period asks for less than 0.2 rad/s, damping in surge for more than
0.35, heave σ for
about 0.34. And the barge's wave damping at any of them is given to the slow motions, which make next to no waves.
Matrices that follow the
frequency give periods of {periods} s and {damping} % by the lines: hence `radiation: cummins` in the example."""


def _differences(study: Study) -> str:
    s, v = study.fpso.summary, study.fpso.vector.summary
    similar, waves, sea = (study.side[name] for name in ("similar", "waves", "sea"))
    seeds = similar.summary["time_domain"]["realisations"]
    whole, part = (tables.ratio(one, s, "lf", "yaw") for one in (s, v))
    tenth = [tables.ratio(one.summary, similar.summary, "lf", "yaw") for one in (similar.result, similar.vector)]
    surge = [tables.ratio(one, s, "lf", "surge") for one in (s, v)]
    roll = [np.degrees(one.summary["time_domain"]["vessel_std"]["lf"]["roll"]) for one in (study.fpso, waves)]
    small = tables.ratio(sea.summary, sea.summary, "lf", "yaw")
    border = float(runs.example("fpso-2000m")["analyses"]["frequency_domain"]["wave"]["from"])
    linear_roll = np.degrees(s["frequency_domain"]["vessel_std"]["lf"]["roll"])
    yaw = [np.degrees(s[f"{domain}_domain"]["vessel_std"]["lf"]["yaw"]) for domain in ("frequency", "time")]
    damping = [100 * mode(one, "yaw")["damping_lines"] for one in (s, v)]
    tops = _range(study.fpso, -1), _range(similar, -1), _range(sea, -1)
    bottoms = _range(study.fpso, 0), _range(similar, 0), _range(sea, 0)
    slow_ratio = _range(study.fpso, -1, "lf"), _range(similar, -1, "lf")
    slow = [1e-3 * line["tension_std"]["lf"][-1] for line in waves.summary["time_domain"]["lines"].values()]
    share = 100 * (whole - part) / (whole - 1)
    return f"""## What differs between the domains, and why

Side studies, {seeds} seeds each. *A tenth of every motion, drag kept*: Hs a tenth, C_D and the mean drift tenfold. The
linear system and the drag per
motion are then those of the example, while geometry and seabed see a tenth of the motion: what is still there is
drag's, what goes is theirs.
*Hs × 0.3*: the example in a smaller sea. Motions: same waves over time domain, by components / as a vector. Tension:
frequency domain
by components over time domain, least and largest of the four lines.

{tables.side_table({"base": study.fpso, **study.side})}

**LF yaw.** Frequency domain {yaw[0]:.2f}°, time domain {yaw[1]:.2f}°; in the same waves the ratio is {whole:.3f},
beside a limit of 1.10.

- Shown: it is not sampling, since the waves are the same.
- Shown: it is not the lines' geometry, the seabed or large yaw, since at a tenth of the motion it is still
{tenth[0]:.3f}. Nor does
it go away in a smaller sea ({small:.3f}), where drag still makes nearly all damping in yaw.
- Shown: most of it is how drag is linearised. By components, each normal direction is damped as if the other did not
move; the
time domain has |v| v with the speed in both. As a vector, damping in yaw by the lines is {damping[1]:.1f} instead of
{damping[0]:.1f} %, and the ratio {part:.3f} ({tenth[1]:.3f} at a tenth): {share:.0f} % of the excess is gone.
- Not shown: where the rest comes from. Velocities that are not Gaussian are the candidate. And the vector form is not
nearer in
everything: LF surge goes from {surge[0]:.3f} to {surge[1]:.3f} of the time domain.

![Spectrum of slow yaw in both domains](validation/fpso-yaw.png)

Both domains are far below the check's rough 6.9°. Period and damping in yaw agree with the check (Table 7) and σ of a
linear
motion is in proportion to its load, so the check's slow yaw moment must be about {6.9 / yaw[0]:.1f} times ours. Ours
comes from drift
data that a control cylinder round the barge confirms ([barge.md](barge.md)). Not shown: what moment the check took. The
paper's 6.87° is another
hull's.

**LF roll.** {roll[0]:.4f}° in the time domain, {linear_roll:.4f}° in the frequency domain: both next to nothing, and
the limit in
percent is missed by far. With drift forces switched off the time domain still has {roll[1]:.4f}°: it is made by
wave-frequency motion, as no
linear method has it. Its ratio is the same at a tenth of the motion, so drag makes it, not geometry: products of three
wave
frequencies in |v| v reach below {border:g} rad/s, and the spectrum above shows a floor there, no peak.

**LF tension.** For the same reason: wave-frequency motion alone makes {min(slow):.0f} to {max(slow):.0f} kN at the top.
Frequency over
time domain is {slow_ratio[0]} in the example and {slow_ratio[1]} at a tenth of the motion. Added to the frequency
domain by variances it gives the time domain's:

{tables.waves_table(study.fpso, waves)}

Without drift forces: {seeds} seeds; the others: {len(s["provenance"]["seeds"])}. Vessel motion of the frequency domain
is that in the same waves.

**WF tension.** At the top the frequency domain is at {tops[0]} of the time domain, at the bottom at {bottoms[0]}. At a
tenth of the motion it is {tops[1]} and {bottoms[1]}: the gap does not vanish with the motion, so it is drag's, not
geometry's or the seabed's. With Hs × 0.3 it is {tops[2]} and {bottoms[2]}. The time domain's spectrum of tension has a
floor above
0.8 rad/s that the frequency domain lacks: the products again."""


def _range(pair: runs.Pair, element: int, band: str = "wf") -> str:
    """Least and largest frequency domain over time domain of tension, all lines."""
    s = pair.summary
    found = [
        tables.tension(s, "frequency", band, element, name) / tables.tension(s, "time", band, element, name)
        for name in s["time_domain"]["lines"]
    ]
    return f"{min(found):.3f} to {max(found):.3f}"


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, help="realisations of the FPSO (default: the example's)")
    parser.add_argument("--duration", type=float, help="kept seconds of the FPSO (default: the example's)")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--out", type=Path, default=Path(__file__).parent)
    parser.add_argument("--keep", type=Path, help="folder that holds solved cases between calls")
    options = parser.parse_args(arguments)
    import validation_plots as plots  # needs matplotlib

    def tell(text: str) -> None:
        print(text, flush=True)

    study = runs.whole_study(Runner(options.seeds, options.duration, options.threads, options.keep, tell))
    plots.draw_all(study, options.out / "validation")
    (options.out / "validation.md").write_text(page(study), encoding="utf-8")


if __name__ == "__main__":
    main()
