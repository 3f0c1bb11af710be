"""Decks and cases that the tests of this folder share."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HEAD = "------ MoorDyn Input File ------\na semi-submersible\nTRUE Echo - echo the input (flag)\n"
TYPES = """---------------------- LINE TYPES ------------------
Name  Diam  MassDen  EA  BA/-zeta  EI  Cd  Ca  CdAx  CaAx
(-)   (m)   (kg/m)   (N) (N-s/-)   (-) (-) (-) (-)   (-)
main  0.333 685.00   3.27E+09  -1.0 0  2.0 0.82 0.4  0.27
rope  0.2   30.0     4e7  -0.8   1e3 1.2 1.0 0.1 0.0  ! polyester
"""
POINTS = """---------------------- POINTS ----------------------
ID Attachment X Y Z M V CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Vessel -58 0 -14 0 0 0 0
2 Fixed -837.6 0 -200 0 0 0 0
3 Free  -300 0 -100 1500 1.2 3.5 0.6
"""
LINES = """---------------------- LINES -----------------------
ID LineType AttachA AttachB UnstrLen NumSegs Outputs
(-) (-) (-) (-) (m) (-) (-)
1 rope 1 3 250 12 p
2 main 2 3 600 30 -
"""
OPTIONS = """---------------------- SOLVER OPTIONS ---------------
0.001 dtM - time step
3.0e6 kbot - bottom stiffness
3.0e5 cbot - bottom damping
200 WtrDpth - depth
---------------------- OUTPUTS ----------------------
FairTen1
END
------------------------- need this line ------------
"""
DECK = HEAD + TYPES + POINTS + LINES + OPTIONS
V1 = """MoorDyn input file for a model at scale
------------- LINE DICTIONARY -------------
LineType Diam MassDenInAir EA BA/-zeta Can Cat Cdn Cdt
(-) (m) (kg/m) (N) (Pa-s/-) (-) (-) (-) (-)
Bot 0.0025 0.149 8.1e5 -0.8 1 0.5 1.4 0.2
------------- NODE PROPERTIES -------------
Node Type X Y Z M V FX FY FZ CdA CA
(-) (-) (m) (m) (m) (kg) (m^3) (kN) (kN) (kN) (m^2) (-)
1 Fix -4.34 0 -1.25 0 0 0 0 0 0 0
2 Connect -1.2 0 -0.4 63.4e-3 2.47e-04 0 0 0 1 1
3 Vessel -0.24 0.15 -0.132 0 0 0 0 0 0 0
------------- LINE PROPERTIES -------------
Line LineType UnstrLen NumSegs NodeAnch NodeFair Flags/Outputs
(-) (-) (m) (-) (-) (-) (-)
1 Bot 3.25 10 1 2 p
2 Bot 1.5 3 2 3 p
------------- SOLVER OPTIONS --------------
1e-5 dtM - time step
1000 rhoW - water density
0 WaveKin - wave kinematics flag
1.25 WtrDpth - water depth (m)
"""
VESSEL = """
vessel:
  mass: 2.0118e7
  centre_of_gravity: [0, 0, -1.7]
  inertia: [[4.45e10, 0, 0], [0, 4.45e10, 0], [0, 0, 2.4e10]]
  hydrostatics:
    stiffness: [[0,0,0,0,0,0], [0,0,0,0,0,0], [0,0,4.5e6,0,0,0], [0,0,0,2e9,0,0], [0,0,0,0,2e9,0], [0,0,0,0,0,0]]
"""


def volturnus() -> Path:
    """The folder of VolturnUS-S' public files; skips where it is not."""
    named = os.environ.get("SLOWDRIFT_VOLTURNUS")
    for folder in [Path(named)] if named else [ROOT.parent / "shared" / "data" / "volturnus-s"]:
        if folder.is_dir():
            return folder
    pytest.skip("the files of VolturnUS-S are not here; name their folder in SLOWDRIFT_VOLTURNUS")
