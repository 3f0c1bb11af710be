"""The question: frozen pydantic models in SI, and the door through which a case comes in."""

from .analysis import ANALYSES
from .case import Case, end_point, harmonic_frequencies, parse_case
from .quantities import DOF
from .text import load_case, to_yaml

__all__ = ["ANALYSES", "DOF", "Case", "end_point", "harmonic_frequencies", "load_case", "parse_case", "to_yaml"]
