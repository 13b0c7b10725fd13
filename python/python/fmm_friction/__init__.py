"""Friction out of measured ring-downs, force and impact records, with uncertainties that can be defended.

>>> import fmm_friction as fmm
>>> found = fmm.identify("run.csv", mass=10.391, normal_load=14)  # doctest: +SKIP
>>> found.findings["mu"].value  # doctest: +SKIP

The functions are the commands of the program ``fmm``, and their keywords its options with underscores.
"""

from importlib.metadata import version as _version

from .commands import backbone, batch, budget, compare, design, force, formats, frf, identify, laws, simulate
from .errors import FmmError
from .law import Law, Parameter
from .results import (
    Backbone,
    Budget,
    Campaign,
    Curve,
    Design,
    Finding,
    Findings,
    Force,
    FrequencyResponse,
    Identification,
    Modes,
    Motion,
    Result,
)

__version__ = _version("fmm_friction")

__all__ = [
    "Backbone",
    "Budget",
    "Campaign",
    "Curve",
    "Design",
    "Finding",
    "Findings",
    "FmmError",
    "Force",
    "FrequencyResponse",
    "Identification",
    "Law",
    "Modes",
    "Motion",
    "Parameter",
    "Result",
    "backbone",
    "batch",
    "budget",
    "compare",
    "design",
    "force",
    "formats",
    "frf",
    "identify",
    "laws",
    "simulate",
]
