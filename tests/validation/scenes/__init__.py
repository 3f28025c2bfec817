"""Small scenes for the comparison with RADIANCE, a material family or a type of light each."""

from .case import Case
from .lights import LIGHTS
from .materials import MATERIALS
from .rooms import ROOMS
from .tables import TABLES

CASES: tuple[Case, ...] = (*LIGHTS, *MATERIALS, *TABLES, *ROOMS)
"""All scenes."""

__all__ = ["CASES", "Case"]
