"""The analytical cases of CIE 171:2006 as Radiance scenes through gonio, beside what they must give."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from .daylight import facades, flux, masks, roofs
from .lamps import area_light, glass, interreflection, obstruction, point_light, reflection
from .rooms import Effort, Row

__all__ = ["CASES", "LONG", "QUICK", "Case", "Row"]

QUICK = Effort(skies=(1, 12), samples=1 << 11)
LONG = Effort(skies=(1, 5, 12), samples=1 << 13)


@dataclass(frozen=True)
class Case:
    """A section of the standard."""

    number: str
    title: str
    rows: Callable[[Effort], list[Row]]


CASES = (
    Case("5.2", "point light", point_light),
    Case("5.3", "area light", area_light),
    Case("5.4", "conservation of flux", flux),
    Case("5.5", "directional transmittance of clear glass", glass),
    Case("5.6", "reflection by diffuse surfaces", reflection),
    Case("5.7", "internal obstruction", obstruction),
    Case("5.8", "internally reflected component", interreflection),
    Case("5.9", "sky through an open roof", lambda e: roofs(e, glazed=False)),
    Case("5.10", "sky through a glazed roof", lambda e: roofs(e, glazed=True)),
    Case("5.11", "sky and ground through an open facade", lambda e: facades(e, glazed=False)),
    Case("5.12", "sky and ground through a glazed facade", lambda e: facades(e, glazed=True)),
    Case("5.13", "sky under a horizontal mask", lambda e: masks(e, upright=False)),
    Case("5.14", "sky over a vertical mask", lambda e: masks(e, upright=True)),
)
