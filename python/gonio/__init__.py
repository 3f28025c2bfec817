"""gonio: from the raw readings of a goniophotometer to a checked scattering model."""

from gonio._native import (
    FLAGS,
    Bsdf,
    DomainError,
    FitError,
    FormatError,
    GonioError,
    HemisphericalIntegral,
    QuantityError,
    Scan,
    Slice,
    Verdict,
    __version__,
)
from gonio.checking import check
from gonio.demonstrating import DemoResult, demo
from gonio.inspecting import inspect
from gonio.measurement import Measurement
from gonio.processing import process
from gonio.readings import Readings, read
from gonio.reporting import report
from gonio.simulating import simulate

__all__ = [
    "FLAGS",
    "Bsdf",
    "DemoResult",
    "DomainError",
    "FitError",
    "FormatError",
    "GonioError",
    "HemisphericalIntegral",
    "Measurement",
    "QuantityError",
    "Readings",
    "Scan",
    "Slice",
    "Verdict",
    "__version__",
    "check",
    "demo",
    "inspect",
    "process",
    "read",
    "report",
    "simulate",
]
