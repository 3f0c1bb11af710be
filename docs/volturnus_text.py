"""The words of docs/validation-volturnus.md; docs/make_volturnus.py puts the numbers in."""

TEXT = """# VolturnUS-S

The UMaine VolturnUS-S semi-submersible with the IEA 15 MW turbine: public WAMIT data (.1, .3, .12d, .hst) and MoorDyn
deck of IEAWindTask37/IEA-15-240-RWT, `examples/volturnus-s.yaml`. Written by `python docs/make_volturnus.py` from
real runs; every number of Slowdrift's is computed there, none is typed in. Slowdrift {version}.

What is left out of the model: wind. The rotor's thrust, its aerodynamic damping (much of the damping of surge and
pitch in operation) and its gyroscopic moments are in neither data nor deck, so this is a parked turbine in still air.
Tower and blades are rigid. The .12d holds waves along x only, so the storm comes along x.

## Natural periods

{periods}

"Example" has the chain of the deck, 0.333 m of displaced diameter, and the platform of the design report (Allen et
al. 2020, NREL/TP-5000-76773: centre of gravity at -14.94 m). RAFT ran with the same WAMIT data, about the unloaded
position, with its own VolturnUS-S example for mass and mooring.

Surge differs from RAFT's by the mooring, not by the method: RAFT's example gives the chain a diameter of 0.185 m, the
nominal one, and takes its buoyancy from it, so that it is 10 % heavier in water than the deck's. With that diameter
our periods are RAFT's within 1 %. With the deck's, an elastic catenary on a flat bed gives 71.9 kN/m for the three
lines and 134.1 s (MoorPy 1.2: 71.9 kN/m), and 79.1 kN/m and 127.9 s with 0.185 m (MoorPy: 79.1); the lines' own
inertia, 2 % of the mass, adds 1 %. The mesh matters too: touchdown moves in steps of an element, so that elements of
17 m are 3 % off in the stiffness of surge (1.5 % in its period); 150 elements of 5.7 m have settled. The
report's 142.9 s of surge is another model's; about which position it was found is not known to us.

Pitch is sensitive to the platform's centre of gravity: the OpenFAST files of the same repository later moved it to
-14.40 m, which lengthens pitch by 0.8 s (last column).

## A storm in both domains

JONSWAP Hs 10.7 m, Tp 14.2 s, γ 2.75, full difference-frequency QTF, mean drift {drift:.0f} kN, static offset
{offset:.2f} m. Time domain: {seeds} seeds of an hour after 20 min of build-up, step {step:g} s, {retried} steps
retried; halving the step changes no σ of seed 1 by more than {halving:.2g} %. Frequency domain: {iterations}
iterations, {fd_wall:.1f} s; the time domain took {wall:.0f} s beside other work. The bands part at 0.25 rad/s, so
that resonance in pitch (0.227 rad/s) is low-frequency. Second-order loads do not end there: difference frequencies go
as far as the QTF and the waves, 1.35 rad/s, so that resonance in heave (0.305 rad/s), above the border and inside the
wave band, answers to them too. By origin, heave has σ = {heave_first:.3f} m in response to the waves and
{heave_second:.3f} m to the slow drift force; all heave below the border has σ = {heave_low:.3f} m.

{sigmas}

Tension is the axial force of the element at the fairlead, static part left out. "Same waves": the linearised system
driven by the very waves of these seeds, so that no sampling noise is left between the domains.

![Spectra of motion and of tension](validation-volturnus/spectra.png)

![Standard deviation of tension along two lines](validation-volturnus/tension.png)

## Where the domains differ, and why

{variants}

Each row takes one nonlinearity away from both domains: first the hull's quadratic damping (AddBQuad of the HydroDyn
file), replaced by the linear damping that is statistically equal to it in this storm, then the drag of the lines.

- Slow drift in surge, {lf_gap:+.1f} %: the linearisation of the hull's quadratic damping. With linear damping the gap
  is {linear_gap:+.1f} % (standard error of the time domain {linear_error:.1f} %). The frequency domain takes the mean
  damping of the whole storm; in the time domain damping is strong inside a group of high waves, where the drift force
  acts, and weak between groups, where surge swings freely. Low-frequency tension follows surge, and so does the small
  slow heave.
- Wave-frequency tension of the head line, {head_gap:+.1f} %: drag on the line, {linear_head:+.1f} % with all of it
  and {thin_head:+.1f} % with a tenth, and the catenary's geometry, which stiffens where slow drift and waves pull the
  line out together. At a tenth of the wave height the gap is {small_head:+.1f} %.
- Motions at wave frequencies agree within 1 % in every row, and the low-frequency pitch within 3 %.
- At a tenth of the wave height first-order quantities have their linear limit; low-frequency ones need not reach it.
  Quadratic drag on hull and lines, and the lines' geometry, make difference-frequency forces of second order in the
  wave height, like the drift itself, and no linearisation has them: slow heave, beside its resonance at 0.31 rad/s,
  agrees with linear hull damping (second row) and is {slow_heave:.0f} % low with quadratic
  damping in a small sea, where it is a motion of millimetres.

Rows three and four are of four seeds, so that their low-frequency tensions scatter by {scatter:.0f} %; motions are
compared under the same waves. The last row has a build-up of two and a half hours, for so small a motion is hardly
damped.
"""
