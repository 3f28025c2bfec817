"""gonio: from the raw readings of a goniophotometer to a checked scattering model."""

from gonio._native import DomainError, FitError, FormatError, GonioError, QuantityError, __version__

__all__ = ["DomainError", "FitError", "FormatError", "GonioError", "QuantityError", "__version__"]
