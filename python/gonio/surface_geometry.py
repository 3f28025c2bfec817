"""Height maps of rough surfaces as geometry that light is traced through."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gonio._native import DomainError, FormatError
from gonio.files import replacing_file
from gonio.surface_files import Surface, read_surface

Array = NDArray[np.float64]

MOST_POINTS = 4_000_000
"""Points of a map, mirrored if it is, that are taken."""

_TYPES = {
    "mirror": "void mirror surface\n0\n0\n3 {0:.9g} {0:.9g} {0:.9g}\n",
    "metal": "void metal surface\n0\n0\n5 {0:.9g} {0:.9g} {0:.9g} 1 0\n",
    "dielectric": "void dielectric surface\n0\n0\n5 1 1 1 {0:.9g} 0\n",
}


@dataclass(frozen=True)
class SurfaceGeometry:
    """A height map as a scene, for `simulate_geometry` and `simulate_readings`.

    `scene` is the file to be read, in micrometres, `mesh` what it refers to; `window` one period of it;
    `rms_slope` of its facets, the root of the mean square of the slope over both axes: the alpha of a
    Beckmann distribution of slopes of the same mean square.
    """

    scene: Path
    mesh: Path
    window: tuple[float, float, float, float]
    rms_slope: float

    @property
    def unit(self) -> float:
        """Metres of a unit of the scene."""
        return 1e-6


def surface(
    source: str | os.PathLike[str] | Surface,
    *,
    out: str | os.PathLike[str],
    material: Literal["mirror", "metal", "dielectric"] = "mirror",
    value: float | None = None,
    joins: bool = False,
    spacing: float | tuple[float, float] | None = None,
    x_unit: str | None = None,
    z_unit: str | None = None,
) -> SurfaceGeometry:
    """Write a height map as geometry that repeats: a Radiance scene with a mesh beside it.

    The mean plane of the map becomes z = 0. Light is traced by geometric optics: structures not far larger
    than its wavelength scatter otherwise.

    Parameters
    ----------
    source
        A file as `gonio.roughness` takes it (`.npy`, `.sdf`, text), or a `Surface`; a map without holes.
    out
        The scene, `.rad`; the mesh is written beside it as `.ply`.
    material
        "mirror", "metal" (whose reflectance rises towards grazing angles as Radiance says), or "dielectric":
        a plate with a flat back, as thick as the map is long.
    value
        Reflectance in [0, 1] of a mirror or metal (default 1), refractive index in [1, 5] of a dielectric
        (default 1.5).
    joins
        Whether the map repeats by itself, its last row before its first. Otherwise it is repeated mirrored,
        which keeps the slopes and makes no steps.
    spacing, x_unit, z_unit
        As for `gonio.roughness`.

    Raises
    ------
    DomainError
        A value outside its range, another ending than `.rad`.
    FormatError
        Not such a file; a profile, a map with holes or with more than 4 million points.
    OSError
        The file system refuses.
    """
    target = Path(out)
    if target.suffix.lower() != ".rad":
        raise DomainError(f"out: found {target.name!r}, allowed a name ending in .rad")
    if material not in _TYPES:
        raise DomainError(f"material: found {material!r}, allowed {', '.join(_TYPES)}")
    low, high, usual = (1.0, 5.0, 1.5) if material == "dielectric" else (0.0, 1.0, 1.0)
    number = usual if value is None else float(value)
    if not low <= number <= high:
        raise DomainError(f"value: found {number:g}, allowed {low:g} to {high:g}")
    heights = (
        source
        if isinstance(source, Surface)
        else read_surface(source, spacing=spacing, x_unit=x_unit, z_unit=z_unit)
    )
    name = heights.path or "surface"
    if heights.dy is None:
        raise FormatError(f"{name}: found a profile, allowed a height map")
    if not np.isfinite(heights.z).all():
        raise FormatError(f"{name}: found points that were not measured, allowed a map without holes")
    z = _period(_level(heights.z), joins=joins)
    if z.size > MOST_POINTS:
        raise FormatError(f"{name}: found {z.size} points with its mirror images, allowed {MOST_POINTS}")
    rows, columns = z.shape
    width, height = (columns - 1) * heights.dx, (rows - 1) * heights.dy
    mesh = target.with_suffix(".ply")
    points, faces = _mesh(z, heights.dx, heights.dy)
    if material == "dielectric":
        points, faces = _with_back(points, faces, width, height)
    scene = _TYPES[material].format(number) + f"surface mesh map\n1 {_word(mesh.name)}\n0\n0\n"
    with replacing_file(mesh) as staged:
        _write_ply(staged, points, faces)
    with replacing_file(target) as staged:
        staged.write_text(scene, encoding="utf-8")
    return SurfaceGeometry(target, mesh, (0.0, 0.0, width, height), _rms_slope(z, heights.dx, heights.dy))


def _word(name: str) -> str:
    """A name as a word of Radiance text: in quotes where it needs them."""
    if not any(c.isspace() or c in "'\"" for c in name):
        return name
    quote = "'" if '"' in name else '"'
    if quote in name:
        raise DomainError(f"out: found {name!r}, allowed a name without both kinds of quotes")
    return f"{quote}{name}{quote}"


def _level(z: Array) -> Array:
    """Without the plane of least squares."""
    rows, columns = z.shape
    y, x = np.mgrid[:rows, :columns]
    x, y = x - x.mean(), y - y.mean()
    flat = z - z.mean()
    return np.asarray(flat - (flat * x).sum() / (x * x).sum() * x - (flat * y).sum() / (y * y).sum() * y)


def _period(z: Array, *, joins: bool) -> Array:
    """One period with its first row and column again at the end."""
    if joins:
        return np.pad(z, ((0, 1), (0, 1)), mode="wrap")
    both = np.concatenate([z, z[-2::-1]], axis=0)
    return np.concatenate([both, both[:, -2::-1]], axis=1)


def _mesh(z: Array, dx: float, dy: float) -> tuple[Array, NDArray[np.int32]]:
    rows, columns = z.shape
    y, x = np.mgrid[:rows, :columns]
    points = np.column_stack([x.ravel() * dx, y.ravel() * dy, z.ravel()])
    corner = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    right, up, across = corner + 1, corner + columns, corner + columns + 1
    faces = np.concatenate(
        [np.column_stack([corner, right, across]), np.column_stack([corner, across, up])]
    ).astype(np.int32)
    return points, faces


def _with_back(
    points: Array, faces: NDArray[np.int32], width: float, height: float
) -> tuple[Array, NDArray[np.int32]]:
    """The mesh and a flat face far below it, which looks down."""
    below = float(points[:, 2].min()) - max(width, height)
    back = [(0.0, 0.0, below), (width, 0.0, below), (width, height, below), (0.0, height, below)]
    n = len(points)
    more = np.array([(n, n + 2, n + 1), (n, n + 3, n + 2)], dtype=np.int32)
    return np.concatenate([points, np.array(back)]), np.concatenate([faces, more])


def _rms_slope(z: Array, dx: float, dy: float) -> float:
    """Of the two triangles of each cell."""
    low = np.diff(z[:-1], axis=1) / dx, np.diff(z[:, 1:], axis=0) / dy
    high = np.diff(z[1:], axis=1) / dx, np.diff(z[:, :-1], axis=0) / dy
    square = sum(float((a**2 + b**2).mean()) for a, b in (low, high)) / 2
    return math.sqrt(square)


def _write_ply(path: Path, points: Array, faces: NDArray[np.int32]) -> None:
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.empty(len(faces), dtype=[("n", "u1"), ("k", "<i4", (3,))])
    rows["n"], rows["k"] = 3, faces
    with path.open("wb") as file:
        file.write(header.encode("ascii"))
        points.astype("<f4").tofile(file)
        rows.tofile(file)
