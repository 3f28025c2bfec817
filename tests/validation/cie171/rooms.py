"""The room of the cases: 4 m x 4 m x 3 m (5.8: 4 m high) and black inside.

x runs across, y from the wall of points A to F (5.2 to 5.10) or from the facade (5.11 to 5.14), z up.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import gonio
import numpy as np

from .exact import Rectangle, Vector, nodes

WHITE = 179.0
"""lx per W/m2 of white in Radiance."""
UP, DOWN = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)
MIDDLES = (0.25, 0.75, 1.25, 1.75, 2.25, 2.75, 3.25, 3.75)
HEIGHTS = (2.75, 2.25, 1.75, 1.25, 0.75, 0.25)
GROUND = 0.3
Sensor = Sequence[float]


@dataclass(frozen=True)
class Row:
    """One value: gonio's with its standard error, the exact one, and the one that the standard prints."""

    where: str
    found: float
    error: float
    exact: float
    printed: float | None = None

    @property
    def tolerance(self) -> float:
        """Four standard errors and 1e-3, for the rounding of gonio's single precision."""
        return 4.0 * self.error + 1e-3 * self.exact

    @property
    def misprint(self) -> float:
        """Difference from the printed value in units of 7 % and one and a half of its last digits (0.015).

        The standard's tables are off the exact values by up to 6 % beside edges of openings (4 m, A)."""
        return 0.0 if self.printed is None else abs(self.found - self.printed) / (0.07 * self.printed + 0.015)


@dataclass(frozen=True)
class Effort:
    """Skies of the daylight cases and paths a sensor."""

    skies: tuple[int, ...]
    samples: int


def polygon(material: str, name: str, corners: Iterable[Sequence[float]]) -> str:
    """Scene text."""
    numbers = [f"{x:.9g}" for corner in corners for x in corner]
    return f"{material} polygon {name} 0 0 {len(numbers)} {' '.join(numbers)}\n"


def corners(rectangle: Rectangle) -> list[list[float]]:
    """Corners of a rectangle, in turn."""
    corner, a, b = (np.asarray(v, dtype=float) for v in rectangle)
    return [list(c) for c in (corner, corner + a, corner + a + b, corner + b)]


BLACK = "void plastic black 0 0 5 0 0 0 0 0\n"


def box(height: float, *, without: str, material: str = "black") -> str:
    """Walls of the room but one: `south`, at y = 0, `top`, or none."""
    walls = {
        "floor": ([0, 0, 0], [4, 0, 0], [0, 4, 0]),
        "top": ([0, 0, height], [0, 4, 0], [4, 0, 0]),
        "south": ([0, 0, 0], [0, 0, height], [4, 0, 0]),
        "north": ([0, 4, 0], [4, 0, 0], [0, 0, height]),
        "west": ([0, 0, 0], [0, 4, 0], [0, 0, height]),
        "east": ([4, 0, 0], [0, 0, height], [0, 4, 0]),
    }
    return "".join(polygon(material, name, corners(w)) for name, w in walls.items() if name != without)


def around(wall: Rectangle, low: Sequence[float], high: Sequence[float]) -> str:
    """A wall without the part between two points, in fractions of its edges."""
    strips = [
        (0.0, 1.0, 0.0, low[1]),
        (0.0, 1.0, high[1], 1.0),
        (0.0, low[0], low[1], high[1]),
        (high[0], 1.0, low[1], high[1]),
    ]
    text = ""
    for k, (u0, u1, v0, v1) in enumerate(strips):
        if u1 > u0 and v1 > v0:
            text += polygon("black", f"strip{k}", corners(part(wall, (u0, v0), (u1, v1))))
    return text


def part(wall: Rectangle, low: Sequence[float], high: Sequence[float]) -> Rectangle:
    """The rectangle between two points of another, in fractions of its edges."""
    corner, a, b = (np.asarray(v, dtype=float) for v in wall)
    return corner + low[0] * a + low[1] * b, (high[0] - low[0]) * a, (high[1] - low[1]) * b


def read(
    text: str,
    sensors: Sequence[Sensor],
    *,
    samples: int,
    bounces: int = 64,
    seed: int = 1,
    files: dict[str, str] | None = None,
) -> tuple[Vector, Vector]:
    """Irradiance over that of white (that is lx / 179) and its standard error."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in {"scene.rad": text, **(files or {})}.items():
            (Path(folder) / name).write_text(content)
        scene, warnings = gonio.read_scene(Path(folder) / "scene.rad")
        if warnings:
            raise AssertionError(warnings)
    found = gonio.render_sensors(
        scene, sensors, samples=samples, relative_error=None, bounces=bounces, seed=seed
    )
    return found.illuminance / WHITE, found.standard_error / WHITE


def table(
    names: Iterable[str],
    found: tuple[Vector, Vector],
    exact: Iterable[float],
    prints: Iterable[float | None] | None = None,
) -> list[Row]:
    """Rows of values."""
    exact = list(exact)
    prints = [None] * len(exact) if prints is None else list(prints)
    lists = zip(names, *found, exact, prints, strict=True)
    return [Row(n, float(f), float(e), x, p) for n, f, e, x, p in lists]


WALL = [[2.0, 0.0, z, 0.0, 1.0, 0.0] for z in HEIGHTS]
FLOOR = [[2.0, y, 0.0, *UP] for y in MIDDLES]


def over(sensors: Sequence[Sensor]) -> list[tuple[Vector, Vector]]:
    """Points and normals."""
    return [(np.asarray(s[:3], dtype=float), np.asarray(s[3:], dtype=float)) for s in sensors]


def net(height: float, count: int) -> tuple[list[Sensor], Vector]:
    """Sensors on floor, walls and ceiling of the room, and the area each stands for (Gauss-Legendre)."""
    sensors: list[Sensor] = []
    areas: list[float] = []
    for axis, sides in ((2, (0.0, height)), (1, (0.0, 4.0)), (0, (0.0, 4.0))):
        others = [k for k in range(3) if k != axis]
        (u, wu), (v, wv) = (nodes(count, 0.0, height if k == 2 else 4.0) for k in others)
        for side in sides:
            for i in range(count):
                for j in range(count):
                    place, normal = np.zeros(3), np.zeros(3)
                    place[others[0]], place[others[1]], place[axis] = u[i], v[j], side
                    normal[axis] = 1.0 if side == 0.0 else -1.0
                    sensors.append([*place, *normal])
                    areas.append(float(wu[i] * wv[j]))
    return sensors, np.array(areas)
