"""Radiance's RGB: primaries, luminance, and the way there from CIE XYZ."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

PRIMARIES = ((0.640, 0.330), (0.290, 0.600), (0.150, 0.060))
"""CIE 1931 (x, y) of red, green and blue [Radiance]."""

WHITE = (1.0 / 3.0, 1.0 / 3.0)
"""(x, y) of white: equal energy. Radiance's 0.3333 shifts the luminance weights by 1.2e-4 of their value."""

SHARP = ((1.2694, -0.0988, -0.1706), (-0.8364, 1.8006, 0.0357), (0.0297, -0.0315, 1.0018))
"""XYZ to the sharpened primaries in which Radiance adapts white points [WardEydelberg2002]."""


def _rgb_to_xyz() -> NDArray[np.float64]:
    """Columns are the primaries' XYZ, scaled so that equal RGB is white of luminance 1."""
    x, y = np.array(PRIMARIES).T
    columns = np.stack([x / y, np.ones(3), (1.0 - x - y) / y])
    white = np.array([WHITE[0], WHITE[1], 1.0 - sum(WHITE)]) / WHITE[1]
    scaled: NDArray[np.float64] = columns * np.linalg.solve(columns, white)
    return scaled


RGB_TO_XYZ = _rgb_to_xyz()
"""Matrix from RGB to XYZ; Y of white is 1."""

XYZ_TO_RGB = np.linalg.inv(RGB_TO_XYZ)
"""Its inverse."""


def luminance(rgb: Sequence[float] | NDArray[np.float64]) -> float:
    """Luminance of RGB in Radiance's primaries relative to white: 0.2651 R + 0.6701 G + 0.0648 B."""
    return float(RGB_TO_XYZ[1] @ np.asarray(rgb, dtype=np.float64))


def rgb_of_xyz(xyz: NDArray[np.float64], *, white: NDArray[np.float64]) -> NDArray[np.float64]:
    """RGB of `xyz` (shape (…, 3)) seen under a light of tristimulus values `white`, adapted to equal energy.

    A von Kries scaling in the sharpened primaries turns `white` into (1, 1, 1) [WardEydelberg2002]: a perfect
    white reflector has the RGB (1, 1, 1) under every light. Values out of the gamut are negative.
    """
    sharp = np.array(SHARP)
    white_out = np.array([WHITE[0], WHITE[1], 1.0 - sum(WHITE)]) / WHITE[1]
    gains = (sharp @ white_out) / (sharp @ white)
    adapt = np.linalg.inv(sharp) @ (gains[:, None] * sharp)
    rgb: NDArray[np.float64] = xyz @ (XYZ_TO_RGB @ adapt).T
    return rgb
