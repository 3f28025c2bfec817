"""The profile of a slice in its plane of incidence."""

from dataclasses import dataclass

import numpy as np

from gonio._drawing.directions import SIDES, across, extended_theta, unit_vectors
from gonio._drawing.mesh import Mesh, triangulate
from gonio._drawing.shapes import Bools, Floats, Ints, SliceLike, unusable

PLANE_TOLERANCES = (0.25, 0.5, 1.0, 2.0)
"""Distances from the plane, degrees, tried in turn until enough readings are found to be marked."""


@dataclass(frozen=True)
class Profile:
    """A section through the readings of a slice by its plane of incidence.

    `theta` is the extended polar angle in degrees, −90…270, positive towards the mirror direction; `dsf` and
    `u_dsf` are in 1/sr, with a NaN row at each gap. `rows` are the readings within `tolerance` degrees of the
    plane and `rows_theta` their extended polar angles.
    """

    plane_phi: float
    theta: Floats
    dsf: Floats
    u_dsf: Floats
    rows: Ints
    rows_theta: Floats
    tolerance: float
    interpolated: bool


def plane_of(slice_: SliceLike) -> float:
    """Azimuth in degrees of the half-plane that holds the mirror direction."""
    return float((slice_.phi_i + 180.0) % 360.0)


def section(slice_: SliceLike, meshes: dict[str, Mesh] | None = None) -> Profile:
    """Cut the triangulated readings with the plane of incidence.

    Between two neighbouring readings on either side of the plane the DSF and its uncertainty are interpolated
    linearly; where no triangle was measured the profile has a gap. Readings of one plane only are joined
    directly.
    """
    plane = plane_of(slice_)
    meshes = meshes or {side: triangulate(slice_, side) for side in SIDES}
    dsf, u_dsf = np.asarray(slice_.dsf, float), np.asarray(slice_.u_dsf, float)
    parts = [_cut(mesh, dsf, u_dsf, plane) for mesh in meshes.values() if len(mesh.triangles)]
    parts = [part for part in parts if len(part[0])]
    rows, rows_theta, tolerance = _readings_near(slice_, plane)
    interpolated = bool(parts)
    for side, mesh in meshes.items():
        if len(mesh.triangles) == 0 and len(mesh.rows):
            parts.append(_joined(slice_, side, rows, rows_theta))
    nan = np.array([np.nan])
    joined = [
        np.concatenate([piece for part in parts for piece in (part[k], nan)][:-1] or [np.empty(0)])
        for k in (0, 1, 2)
    ]
    return Profile(plane, joined[0], joined[1], joined[2], rows, rows_theta, tolerance, interpolated)


def _cut(mesh: Mesh, dsf: Floats, u_dsf: Floats, plane: float) -> tuple[Floats, Floats, Floats]:
    """Order the segments in which the plane crosses the triangles; a NaN row parts runs that do not touch."""
    distance = across(mesh.vectors, plane_phi=plane)
    distance = np.where(np.abs(distance) < 1e-9, 1e-9, distance)
    triangles = mesh.triangles
    above = distance[triangles] > 0.0
    crossed = above.any(axis=1) & ~above.all(axis=1)
    triangles, above = triangles[crossed], above[crossed]
    if len(triangles) == 0:
        return np.empty(0), np.empty(0), np.empty(0)
    # The vertex alone on its side of the plane, then the other two: the two crossed edges start at it.
    lone = np.where(above.sum(axis=1) == 1, np.argmax(above, axis=1), np.argmin(above, axis=1))
    pick = np.arange(len(triangles))
    apex = triangles[pick, lone]
    ends = [_cross(mesh, distance, apex, triangles[pick, (lone + k) % 3]) for k in (1, 2)]
    angle = np.stack([extended_theta(vectors, plane_phi=plane) for _, _, _, vectors in ends], axis=1)
    if mesh.side == "front":
        angle = np.where(angle > 180.0, angle - 360.0, angle)
    values = np.stack([_along(dsf[mesh.rows], a, b, t) for a, b, t, _ in ends], axis=1)
    sigmas = np.stack([_along(u_dsf[mesh.rows], a, b, t) for a, b, t, _ in ends], axis=1)
    swap = angle[:, 0] > angle[:, 1]
    for array in (angle, values, sigmas):
        array[swap] = array[swap][:, ::-1]
    return _runs(angle, values, sigmas)


def _cross(mesh: Mesh, distance: Floats, a: Ints, b: Ints) -> tuple[Ints, Ints, Floats, Floats]:
    t = distance[a] / (distance[a] - distance[b])
    return a, b, t, mesh.vectors[a] + t[:, None] * (mesh.vectors[b] - mesh.vectors[a])


def _along(values: Floats, a: Ints, b: Ints, t: Floats) -> Floats:
    return values[a] + t * (values[b] - values[a])


def _runs(angle: Floats, values: Floats, sigmas: Floats) -> tuple[Floats, Floats, Floats]:
    order = np.lexsort((angle[:, 1], angle[:, 0]))
    angle, values, sigmas = angle[order], values[order], sigmas[order]
    reached = np.maximum.accumulate(angle[:, 1])
    breaks = np.flatnonzero(angle[1:, 0] > reached[:-1] + 1e-4) + 1
    out: tuple[list[Floats], list[Floats], list[Floats]] = ([], [], [])
    for start, stop in zip(np.r_[0, breaks], np.r_[breaks, len(angle)], strict=True):
        flat = angle[start:stop].ravel()
        by_angle = np.argsort(flat, kind="stable")
        flat = flat[by_angle]
        distinct = np.r_[True, np.diff(flat) > 1e-4]
        for sink, source in zip(out, (angle, values, sigmas), strict=True):
            sink.append(source[start:stop].ravel()[by_angle][distinct])
            sink.append(np.array([np.nan]))
    theta, dsf, u_dsf = (np.concatenate(sink[:-1]) for sink in out)
    return theta, dsf, u_dsf


def _readings_near(slice_: SliceLike, plane: float) -> tuple[Ints, Floats, float]:
    vectors = unit_vectors(slice_.theta_s, slice_.phi_s)
    finite = ~unusable(slice_.flags, slice_.dsf) & np.isfinite(vectors).all(axis=1)
    off = np.degrees(np.arcsin(np.clip(np.abs(across(vectors, plane_phi=plane)), 0.0, 1.0)))
    tolerance = PLANE_TOLERANCES[-1]
    near: Bools = finite & (off <= tolerance)
    for tried in PLANE_TOLERANCES:
        chosen = finite & (off <= tried)
        if chosen.sum() >= 12:
            near, tolerance = chosen, tried
            break
    rows = np.flatnonzero(near)
    theta = extended_theta(vectors[rows], plane_phi=plane)
    order = np.argsort(theta, kind="stable")
    return rows[order], theta[order], tolerance


def _joined(slice_: SliceLike, side: str, rows: Ints, theta: Floats) -> tuple[Floats, Floats, Floats]:
    """Join the in-plane readings of one hemisphere, open where a step exceeds three typical steps."""
    back = np.asarray(slice_.theta_s, float)[rows] > 90.0
    chosen = back if side == "back" else ~back
    rows, theta = rows[chosen], theta[chosen]
    dsf, u_dsf = np.asarray(slice_.dsf, float)[rows], np.asarray(slice_.u_dsf, float)[rows]
    steps = np.diff(theta)
    wide = (
        np.flatnonzero(steps > 3.0 * max(float(np.median(steps)), 1.0)) + 1
        if len(steps)
        else np.empty(0, int)
    )
    return np.insert(theta, wide, np.nan), np.insert(dsf, wide, np.nan), np.insert(u_dsf, wide, np.nan)
