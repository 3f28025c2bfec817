"""The beam that a condenser lens makes of a round source."""

from __future__ import annotations

import math
from collections.abc import Mapping

from gonio.instrument_keys import Refuse


def lens(
    optics: Mapping[str, float],
    *,
    focus: str,
    distance_mm: float,
    refuse: Refuse,
) -> tuple[float, float]:
    """Return half angle of the beam in degrees and diameter of the spot on the sample in metres.

    A thin lens, its aperture in its plane, stands `lens_to_sample_mm` before the sample and images a source
    of `source_diameter_mm` onto the detector sphere (`focus` "detector") or the sample. With image distance
    b and 1/f = 1/a + 1/b the image has the diameter s b / a. Focused on the detector, the beam is as wide as
    the image seen from the sample, and the spot is the cross-section of the cone from the lens to the image;
    focused on the sample, the spot is the image, and the beam spreads as the lens seen from the sample.
    """
    to_sample, f = optics["lens_to_sample_mm"], optics["focal_length_mm"]
    image = to_sample + (distance_mm if focus == "detector" else 0.0)
    if f >= image:
        raise refuse("optics.focal_length_mm", f"{f:g}", f"less than the way to the image, {image:g}")
    diameter = optics["source_diameter_mm"] * (image / f - 1.0)
    if focus == "sample":
        radius = math.degrees(math.atan(0.5 * optics["aperture_diameter_mm"] / to_sample))
        spot = diameter
    else:
        radius = math.degrees(math.atan(0.5 * diameter / distance_mm))
        spot = (optics["aperture_diameter_mm"] * distance_mm + diameter * to_sample) / image
    for found, high, what in ((radius, 5.7, "a beam of half angle"), (spot, 100.0, "a spot of diameter")):
        if found > high:
            raise refuse("optics", f"{what} {found:.4g}", f"up to {high:g} (degrees, mm)")
    return max(radius, 0.006), 1e-3 * spot
