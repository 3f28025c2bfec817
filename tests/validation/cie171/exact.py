"""What the analytical cases of CIE 171:2006 must give, computed apart from gonio.

Configuration factors of polygons by Lambert's edge sum, light of a sky through an opening by Gauss-Legendre
quadrature over the opening, Fresnel's equations for the pane. Lengths in metres, angles in radians.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]
Rectangle = tuple[Sequence[float], Sequence[float], Sequence[float]]
"""A corner and two edges."""

SKIES = {
    1: (4.0, -0.70, 0.0, -1.0, 0.00),
    5: (0.0, -1.00, 0.0, -1.0, 0.00),
    12: (-1.0, -0.32, 10.0, -3.0, 0.45),
}
"""a to e of ISO 15469, table 1: overcast, uniform, clear."""
INDEX, TRANSMISSIVITY = 1.52, 0.96


def configuration_factor(corners: Sequence[Sequence[float]], point: Vector, normal: Vector) -> float:
    """Share of pi L that a polygon of luminance L above the horizon brings to a point."""
    ways = np.asarray(corners, dtype=float) - point
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    following = np.roll(ways, -1, axis=0)
    across = np.cross(ways, following)
    length = np.linalg.norm(across, axis=1)
    angle = np.arctan2(length, (ways * following).sum(axis=1))
    return float(abs((angle / length * (across @ normal)).sum()) / (2.0 * np.pi))


def sky(kind: int, sun: Vector) -> Callable[[Vector], Vector]:
    """Relative luminance of a standard general sky by direction, shape (..., 3); below the horizon none."""
    a, b, c, d, e = SKIES[kind]

    def luminance(way: Vector) -> Vector:
        z = np.maximum(way[..., 2], 1e-9)
        cosine = np.clip((way * sun).sum(axis=-1), -1.0, 1.0)
        angle = np.arccos(cosine)
        gradation = 1.0 + a * np.exp(b / z)
        value = gradation * (1.0 + c * (np.exp(d * angle) - np.exp(d * np.pi / 2.0)) + e * cosine**2)
        return np.asarray(np.where(way[..., 2] > 0.0, value, 0.0))

    return luminance


def transmittance(cosine: Vector) -> Vector:
    """Of a pane of index 1.52 and transmissivity 0.96, all reflections between its faces included."""
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / INDEX**2)
    path = TRANSMISSIVITY ** (1.0 / inside)
    s = ((cosine - INDEX * inside) / (cosine + INDEX * inside)) ** 2
    p = ((INDEX * cosine - inside) / (INDEX * cosine + inside)) ** 2
    return np.asarray(0.5 * sum((1.0 - r) ** 2 * path / (1.0 - (r * path) ** 2) for r in (s, p)))


def open_to(cosine: Vector) -> Vector:
    """No pane."""
    return np.ones_like(cosine)


def nodes(count: int, low: float, high: float) -> tuple[Vector, Vector]:
    """Gauss-Legendre nodes and weights of an interval."""
    x, w = np.polynomial.legendre.leggauss(count)
    return 0.5 * (high - low) * x + 0.5 * (high + low), 0.5 * (high - low) * w


def through(
    opening: Rectangle,
    point: Vector,
    normal: Vector,
    luminance: Callable[[Vector], Vector],
    pane: Callable[[Vector], Vector] = open_to,
    count: int = 120,
) -> float:
    """Illuminance of a point by what is seen through a rectangle; the integrand must be smooth in it."""
    corner, a, b = (np.asarray(v, dtype=float) for v in opening)
    u, wu = nodes(count, 0.0, 1.0)
    at = corner + u[:, None, None] * a + u[None, :, None] * b
    way = at - point
    distance = np.linalg.norm(way, axis=-1)
    way /= distance[..., None]
    facing = np.cross(a, b)
    area = float(np.linalg.norm(facing))
    through_cos = np.abs((way * facing).sum(axis=-1)) / area
    received = np.maximum((way * normal).sum(axis=-1), 0.0)
    value = luminance(way) * pane(through_cos) * received * through_cos / distance**2
    return float((wu[:, None] * wu * value).sum() * area)


def horizontal(
    luminance: Callable[[Vector], Vector], pane: Callable[[Vector], Vector] = open_to, count: int = 200
) -> float:
    """Illuminance of a horizontal plane under a whole sky."""
    z, wz = nodes(count, 0.0, 1.0)
    phi = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    r = np.sqrt(1.0 - z * z)[:, None]
    way = np.stack([r * np.cos(phi), r * np.sin(phi), np.broadcast_to(z[:, None], (count, count))], axis=-1)
    value = luminance(way) * z[:, None] * pane(way[..., 2])
    return float((wz[:, None] * value).sum() * 2.0 * np.pi / count)
