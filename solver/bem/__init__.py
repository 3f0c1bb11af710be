"""Hydrodynamic data from the shape of a hull: meshes, their quality, and boundary elements with Capytaine's Green function.

Everything but `solve` works without Capytaine, which is the optional extra `bem`.
"""

from .geometry import Hull, prepare
from .spec import HydrodynamicJob, load_job, parse_job

__all__ = ["Hull", "HydrodynamicJob", "load_job", "parse_job", "prepare"]
