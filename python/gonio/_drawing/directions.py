"""Directions for drawing: unit vectors, the two hemispheres, extended polar angles and map projections."""

import numpy as np
import numpy.typing as npt

from gonio._drawing.shapes import Floats

SIDES = ("front", "back")


def side_of(theta: float) -> str:
    """Tell the side a direction with polar angle `theta` (degrees) leaves to; the horizon counts as front."""
    return "back" if theta > 90.0 else "front"


def component_of(theta_i: float, side: str) -> str:
    """`reflection` when `side` is the side of incidence, else `transmission`."""
    return "reflection" if side_of(theta_i) == side else "transmission"


def unit_vectors(theta: npt.ArrayLike, phi: npt.ArrayLike) -> Floats:
    """Give the unit vectors (n, 3) of canonical polar angles in degrees."""
    t, p = np.radians(np.asarray(theta, dtype=float)), np.radians(np.asarray(phi, dtype=float))
    return np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1)


def extended_theta(vectors: Floats, *, plane_phi: float) -> Floats:
    """Give the extended polar angle in degrees of directions in the half-plane `plane_phi` and its opposite.

    −90…90 over the front hemisphere, 90…270 over the back one. Directions off the plane are projected onto
    it.
    """
    p = np.radians(plane_phi)
    along = vectors[..., 0] * np.cos(p) + vectors[..., 1] * np.sin(p)
    angle = np.degrees(np.arctan2(along, vectors[..., 2]))
    extended: Floats = np.where(angle < -90.0, angle + 360.0, angle)
    return extended


def across(vectors: Floats, *, plane_phi: float) -> Floats:
    """Signed sine of the great-circle distance of directions from the plane `plane_phi` (degrees)."""
    p = np.radians(plane_phi)
    distance: Floats = -vectors[..., 0] * np.sin(p) + vectors[..., 1] * np.cos(p)
    return distance


def stereographic(vectors: Floats, side: str) -> Floats:
    """Stereographic projection (n, 2) of a hemisphere from the opposite pole; its rim is the unit circle.

    Circles stay circles, so the plane Delaunay triangulation of the projected points is the spherical one.
    """
    z = vectors[..., 2] if side == "front" else -vectors[..., 2]
    flat: Floats = vectors[..., :2] / (1.0 + np.maximum(z, -0.999))[..., None]
    return flat


def equal_area(vectors: Floats, side: str) -> Floats:
    """Lambert azimuthal equal-area projection (n, 2) of a hemisphere; its rim is the unit circle.

    Both hemispheres are drawn as seen from the front, so azimuth runs counter-clockwise in both and the
    direction of straight transmission lies where the mirror direction lies in the other map.
    """
    z = vectors[..., 2] if side == "front" else -vectors[..., 2]
    flat: Floats = vectors[..., :2] / np.sqrt(1.0 + np.maximum(z, -0.999))[..., None]
    return flat
