"""Radiance's RGB: primaries, luminance, and the way there from CIE XYZ and from sRGB."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

PRIMARIES = ((0.640, 0.330), (0.290, 0.600), (0.150, 0.060))
"""CIE 1931 (x, y) of red, green and blue [Radiance]."""

WHITE = (1.0 / 3.0, 1.0 / 3.0)
"""(x, y) of white: equal energy. Radiance's 0.3333 shifts the luminance weights by 1.2e-4 of their value."""

SRGB_PRIMARIES = ((0.640, 0.330), (0.300, 0.600), (0.150, 0.060))
"""CIE 1931 (x, y) of red, green and blue of sRGB [IEC61966]."""

SRGB_WHITE = (0.3127, 0.3290)
"""(x, y) of its white, D65 [IEC61966]."""

SHARP = ((1.2694, -0.0988, -0.1706), (-0.8364, 1.8006, 0.0357), (0.0297, -0.0315, 1.0018))
"""XYZ to the sharpened primaries in which Radiance adapts white points [WardEydelberg2002]."""


def _xyz_of_white(white: tuple[float, float]) -> NDArray[np.float64]:
    """XYZ of luminance 1."""
    return np.array([white[0], white[1], 1.0 - sum(white)]) / white[1]


def _rgb_to_xyz(
    primaries: tuple[tuple[float, float], ...], white: tuple[float, float]
) -> NDArray[np.float64]:
    """Columns are the primaries' XYZ, scaled so that equal RGB is white of luminance 1."""
    x, y = np.array(primaries).T
    columns = np.stack([x / y, np.ones(3), (1.0 - x - y) / y])
    scaled: NDArray[np.float64] = columns * np.linalg.solve(columns, _xyz_of_white(white))
    return scaled


RGB_TO_XYZ = _rgb_to_xyz(PRIMARIES, WHITE)
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
    gains = (sharp @ _xyz_of_white(WHITE)) / (sharp @ white)
    adapt = np.linalg.inv(sharp) @ (gains[:, None] * sharp)
    rgb: NDArray[np.float64] = xyz @ (XYZ_TO_RGB @ adapt).T
    return rgb


def rgb_of_srgb(srgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """RGB of linear sRGB (shape (…, 3)): to XYZ by the primaries of [IEC61966], then as `rgb_of_xyz`.

    The light is D65, the white of sRGB: white stays (1, 1, 1), grey stays grey. Values out of the gamut are
    negative.
    """
    xyz = srgb @ _rgb_to_xyz(SRGB_PRIMARIES, SRGB_WHITE).T
    return rgb_of_xyz(xyz, white=_xyz_of_white(SRGB_WHITE))


def rgb_to_srgb(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """Linear sRGB of RGB (shape (…, 3)), the inverse of `rgb_of_srgb`; negative out of the gamut."""
    forward = rgb_of_srgb(np.eye(3))
    srgb: NDArray[np.float64] = rgb @ np.linalg.inv(forward)
    return srgb
