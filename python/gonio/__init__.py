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
from gonio.measurement import Measurement

__all__ = [
    "FLAGS",
    "Bsdf",
    "DomainError",
    "FitError",
    "FormatError",
    "GonioError",
    "HemisphericalIntegral",
    "Measurement",
    "QuantityError",
    "Scan",
    "Slice",
    "Verdict",
    "__version__",
]
