"""Triangulated readings of one hemisphere, with unmeasured regions left open."""

from dataclasses import dataclass

import numpy as np
from matplotlib.tri import Triangulation

from gonio._drawing.directions import across, stereographic, unit_vectors
from gonio._drawing.quadtree import representatives
from gonio._drawing.shapes import Bools, Floats, Ints, SliceLike, unusable

GAP_FACTOR = 2.2
"""A triangle this many times wider than the typical one spans a gap."""

MOST_TRIANGULATED = 80_000
"""Readings of one hemisphere that are triangulated; of more, peaks and the plane of incidence are kept."""

NEAR_PLANE = 0.25
"""Readings within this many degrees of the plane of incidence are always triangulated."""

GAP_LEAST = 1.5
"""No triangle with a circumradius below this many degrees is a gap."""

GAP_MOST = 15.0
"""Every triangle with a circumradius above this many degrees is a gap."""


@dataclass(frozen=True)
class Mesh:
    """Usable readings of one hemisphere and the triangles between neighbours.

    `rows` are the indices of the readings in their slice, `vectors` (n, 3) their directions, `triangles` (m,
    3) index into `rows`. A reading of a direction that was read before is left out. `gap` is the circumradius
    in degrees above which a triangle counts as unmeasured and is left out; zero when nothing could be
    triangulated.
    """

    side: str
    rows: Ints
    vectors: Floats
    triangles: Ints
    gaps: Ints
    gap: float


def triangulate(slice_: SliceLike, side: str) -> Mesh:
    """Delaunay-triangulate the usable readings of `slice_` on `side`.

    Triangles wider than `GAP_FACTOR` times the typical one (the median over the sphere's area of the
    circumradius) are dropped: there was no reading there, and a drawing must not invent one. Readings that
    cannot be triangulated (fewer than three, or all in one plane) give a mesh without triangles.
    """
    theta = np.asarray(slice_.theta_s, dtype=float)
    phi = np.asarray(slice_.phi_s, dtype=float)
    on_side = (theta > 90.0) if side == "back" else (theta <= 90.0)
    keep = on_side & ~unusable(slice_.flags, slice_.dsf) & np.isfinite(phi)
    rows = np.flatnonzero(keep)
    vectors = unit_vectors(theta[rows], phi[rows])
    if len(rows) > MOST_TRIANGULATED:
        chosen = _fewer(slice_, side, rows, vectors)
        rows, vectors = rows[chosen], vectors[chosen]
    rows, vectors = _without_repeats(rows, vectors)
    triangles = _delaunay(stereographic(vectors, side))
    if len(triangles) == 0:
        return Mesh(side, rows, vectors, triangles, triangles, 0.0)
    radius, area = _circumradius_and_area(vectors, triangles)
    gap = float(np.clip(GAP_FACTOR * _weighted_median(radius, area), GAP_LEAST, GAP_MOST))
    return Mesh(side, rows, vectors, triangles[radius <= gap], triangles[radius > gap], gap)


def coarsened(mesh: Mesh, chosen: Ints) -> Mesh:
    """Triangulate the readings `chosen` (positions in `mesh.rows`) again, keeping the gaps of `mesh` open.

    A new triangle is dropped when its centre, or the middles of two of its edges, lie in a gap of `mesh`.
    """
    vectors = mesh.vectors[chosen]
    flat = stereographic(mesh.vectors, mesh.side)
    points = flat[chosen]
    triangles = _delaunay(points) if len(mesh.triangles) else mesh.triangles
    a, b, c = (points[triangles[:, k]] for k in range(3))
    gaps = flat[mesh.gaps]
    centre = _inside_any((a + b + c) / 3.0, gaps)
    edges = np.sum([_inside_any(0.5 * (p + q), gaps) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    lost: Bools = np.logical_or(centre, edges >= 2)
    return Mesh(mesh.side, mesh.rows[chosen], vectors, triangles[~lost], triangles[lost], mesh.gap)


def _inside_any(points: Floats, triangles: Floats) -> Bools:
    """Tell which points (n, 2) lie strictly inside any of the triangles (m, 3, 2)."""
    inside = np.zeros(len(points), dtype=bool)
    if len(points) == 0 or len(triangles) == 0:
        return inside
    order = np.argsort(points[:, 0])
    sorted_x = points[order, 0]
    low = np.searchsorted(sorted_x, triangles[:, :, 0].min(axis=1))
    high = np.searchsorted(sorted_x, triangles[:, :, 0].max(axis=1), side="right")
    for corners, start, stop in zip(triangles, low, high, strict=True):
        if start < stop:
            near = order[start:stop]
            inside[near] |= _inside(points[near], corners)
    return inside


def _inside(points: Floats, corners: Floats) -> Bools:
    towards = np.roll(corners, -1, axis=0) - corners
    offset = points[:, None, :] - corners[None, :, :]
    cross = towards[None, :, 0] * offset[:, :, 1] - towards[None, :, 1] * offset[:, :, 0]
    inside: Bools = np.abs(np.sign(cross).sum(axis=1)) == 3.0
    return inside


def _fewer(slice_: SliceLike, side: str, rows: Ints, vectors: Floats) -> Ints:
    dsf = np.asarray(slice_.dsf, dtype=float)[rows]
    scale = 1e-4 * float(np.max(np.abs(dsf)))
    few = representatives(vectors, dsf, side=side, most=MOST_TRIANGULATED, floor=scale)
    near = np.flatnonzero(
        np.abs(across(vectors, plane_phi=float(slice_.phi_i))) < np.sin(np.radians(NEAR_PLANE))
    )
    return np.union1d(few, near)


def _without_repeats(rows: Ints, vectors: Floats) -> tuple[Ints, Floats]:
    _, first = np.unique(np.round(vectors, 7), axis=0, return_index=True)
    first.sort()
    return rows[first], vectors[first]


def _delaunay(points: Floats) -> Ints:
    empty = np.empty((0, 3), dtype=np.int64)
    if len(points) < 3 or _in_one_line(points):
        return empty
    try:
        return np.asarray(Triangulation(points[:, 0], points[:, 1]).triangles, dtype=np.int64)
    except (RuntimeError, ValueError):  # qhull finds the points degenerate
        return empty


def _in_one_line(points: Floats) -> bool:
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(spread[-1] <= 1e-6 * max(float(spread[0]), 1e-300))


def _circumradius_and_area(vectors: Floats, triangles: Ints) -> tuple[Floats, Floats]:
    a, b, c = (vectors[triangles[:, k]] for k in range(3))
    la, lb, lc = (np.linalg.norm(p - q, axis=1) for p, q in ((b, c), (c, a), (a, b)))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        radius = la * lb * lc / (4.0 * area)
    radius = np.where(np.isfinite(radius), radius, np.inf)
    return np.degrees(np.arcsin(np.minimum(radius, 1.0))), area


def _weighted_median(values: Floats, weights: Floats) -> float:
    order = np.argsort(values)
    running = np.cumsum(weights[order])
    return float(values[order][np.searchsorted(running, 0.5 * running[-1])])
