"""Cases 5.4 and 5.9 to 5.14: skies through openings."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from . import printed
from .exact import SKIES, Rectangle, Vector, horizontal, open_to, sky, through, transmittance
from .rooms import (
    BLACK,
    DOWN,
    FLOOR,
    GROUND,
    HEIGHTS,
    MIDDLES,
    UP,
    WALL,
    WHITE,
    Effort,
    Row,
    Sensor,
    around,
    box,
    corners,
    net,
    over,
    part,
    polygon,
    read,
    table,
)

CAL = """chi = acos(min(1, max(-1, Dx*A6 + Dy*A7 + Dz*A8)));
cie = if(Dz, (1 + A1*exp(A2/Dz)) * (1 + A3*(exp(A4*chi) - exp(A4*PI/2)) + A5*cos(chi)^2), 0);
"""
PANES = "void glass pane 0 0 3 .96 .96 .96\nvoid glass none 0 0 4 1 1 1 1\n"
"""The second has the index 1: nothing but a portal, which tells gonio where light comes in."""


def under(
    kind: int,
    sun: Sequence[float],
    text: str,
    sensors: Sequence[Sensor],
    *,
    samples: int,
    seed: int = 1,
) -> tuple[Vector, Vector]:
    """Per cent of the illuminance that the unobstructed sky gives to the horizontal.

    The ground has the uniform luminance of a reflectance of 0.3.
    """
    level = horizontal(sky(kind, np.asarray(sun)))
    numbers = " ".join(f"{x:.9g}" for x in (*SKIES[kind], *sun))
    ground = GROUND * level / np.pi
    head = f"void brightfunc f 2 cie sky.cal 0 8 {numbers}\nf glow g 0 0 4 1 1 1 0\n"
    head += f"g source above 0 0 4 0 0 1 180\nvoid glow soil 0 0 4 {ground} {ground} {ground} 0\n"
    head += "soil source below 0 0 4 0 0 -1 180\n"
    value, error = read(
        head + BLACK + PANES + text, sensors, samples=samples, seed=seed, files={"sky.cal": CAL}
    )
    return 100.0 * value / level, 100.0 * error / level


def roof(side: float, glazed: bool) -> tuple[str, Rectangle]:
    """The room with a square opening in the middle of its ceiling."""
    ceiling: Rectangle = ([0, 0, 3.0], [4.0, 0, 0], [0, 4.0, 0])
    low, high = 0.5 - side / 8.0, 0.5 + side / 8.0
    opening = part(ceiling, (low, low), (high, high))
    text = box(3.0, without="top") + around(ceiling, (low, low), (high, high))
    return text + polygon("pane" if glazed else "none", "opening", corners(opening)), opening


def facade(width: float, glazed: bool) -> tuple[str, Rectangle]:
    """The room with an opening in the wall y = 0: 2 m x 1 m at a height of 1 m, or all of it."""
    wall: Rectangle = ([0, 0, 0], [4.0, 0, 0], [0, 0, 3.0])
    low, high = ((0.25, 1 / 3), (0.75, 2 / 3)) if width == 2.0 else ((0.0, 0.0), (1.0, 1.0))
    opening = part(wall, low, high)
    text = box(3.0, without="south") + around(wall, low, high)
    return text + polygon("pane" if glazed else "none", "opening", corners(opening)), opening


def roofs(effort: Effort, *, glazed: bool) -> list[Row]:
    """5.9, 5.10: light of the sky through the roof; the sun stands at 60 degrees over +y."""
    sun = np.array([0.0, 0.5, np.sqrt(0.75)])
    rows = []
    for side in (1.0, 4.0):
        text, opening = roof(side, glazed)
        for kind in effort.skies:
            level = horizontal(sky(kind, sun))
            pane = transmittance if glazed else open_to
            exact = [
                100.0 * through(opening, p, n, sky(kind, sun), pane) / level for p, n in over(WALL + FLOOR)
            ]
            names = [f"{side:g} m, sky {kind}, {c}" for c in "ABCDEFGHIJKLMN"]
            found = under(kind, sun, text, WALL + FLOOR, samples=effort.samples)
            rows += table(names, found, exact, printed.ROOF.get((kind, int(side), glazed)))
    return rows


def split(opening: Rectangle, heights: Iterable[float]) -> list[Rectangle]:
    """An upright opening cut at heights."""
    corner, a, b = (np.asarray(v, dtype=float) for v in opening)
    bottom, top = float(corner[2]), float(corner[2] + b[2])
    cuts = [bottom, *sorted(h for h in heights if bottom < h < top), top]
    up = np.array([0.0, 0.0, 1.0])
    return [(corner + (low - bottom) * up, a, (high - low) * up) for low, high in itertools.pairwise(cuts)]


def outside(
    opening: Rectangle,
    point: Vector,
    normal: Vector,
    kind: int,
    pane: Callable[[Vector], Vector],
    hidden: tuple[float, float] = (np.inf, -np.inf),
    *,
    level: float,
) -> float:
    """Per cent of `level` through an upright opening: the sky above the point's height, the ground below.

    Nothing comes through what lies above the first or below the second of the `hidden` heights.
    """
    sun = np.array([0.0, -0.5, np.sqrt(0.75)])
    shine = sky(kind, sun)

    def seen(way: Vector) -> Vector:
        return np.where(way[..., 2] > 0.0, shine(way), GROUND * level / np.pi)

    total = 0.0
    for piece in split(opening, (float(point[2]), *hidden)):
        middle = piece[0][2] + 0.5 * piece[2][2]
        if middle < hidden[0] and (middle > hidden[1]):
            total += through(piece, point, normal, seen, pane)
    return 100.0 * total / level


FAR_WALL = [[2.0, 4.0, z, 0.0, -1.0, 0.0] for z in HEIGHTS]
FROM_AFAR = [[2.0, y, 0.0, *UP] for y in reversed(MIDDLES)]
ABOVE = [[2.0, y, 3.0, *DOWN] for y in reversed(MIDDLES)]


def facades(effort: Effort, *, glazed: bool) -> list[Row]:
    """5.11, 5.12: light of sky and ground through the facade; the sun at 60 degrees before it."""
    sun = (0.0, -0.5, np.sqrt(0.75))
    sensors = FAR_WALL + FROM_AFAR + ABOVE
    letters = [*"ABCDEFGHIJKLMN", *(f"{c}'" for c in "GHIJKLMN")]
    rows = []
    for width in (2.0, 4.0):
        text, opening = facade(width, glazed)
        for kind in effort.skies:
            pane = transmittance if glazed else open_to
            level = horizontal(sky(kind, np.array(sun)))
            exact = [outside(opening, p, n, kind, pane, level=level) for p, n in over(sensors)]
            known = printed.FACADE.get((kind, int(width), glazed))
            prints = None if known is None else known + printed.CEILING[int(width), glazed]
            names = [f"{width:g} m, sky {kind}, {c}" for c in letters]
            found = under(kind, sun, text, sensors, samples=effort.samples)
            rows += table(names, found, exact, prints)
    return rows


def masks(effort: Effort, *, upright: bool) -> list[Row]:
    """5.13: a board over the facade, 0.5 to 2 m deep; 5.14: a wall 6 m off, 3 to 9 m high."""
    sun = (0.0, -0.5, np.sqrt(0.75))
    rows = []
    for size in (3.0, 6.0, 9.0) if upright else (0.5, 1.0, 2.0):
        text, opening = facade(2.0, glazed=False)
        if upright:
            board = [[-30, -6, 0], [34, -6, 0], [34, -6, size], [-30, -6, size]]
        else:
            board = [[-30, 0, 3], [34, 0, 3], [34, -size, 3], [-30, -size, 3]]
        for kind in effort.skies:
            exact = []
            level = horizontal(sky(kind, np.array(sun)))
            for p, n in over(FROM_AFAR):
                # Heights in the opening at which the edge of the mask is seen.
                edge = size / (1.0 + 6.0 / p[1]) if upright else 3.0 / (1.0 + size / p[1])
                hidden = (np.inf, edge) if upright else (edge, -np.inf)
                exact.append(outside(opening, p, n, kind, open_to, hidden, level=level))
            found = under(
                kind, sun, text + polygon("black", "mask", board), FROM_AFAR, samples=4 * effort.samples
            )
            rows += table([f"{size:g} m, sky {kind}, {c}" for c in "ABCDEFGH"], found, exact)
    return rows


def flux(_: Effort) -> list[Row]:
    """5.4: what a lamp of 10 000 lm, or sky 1 through a roof, brings to all walls together."""
    sensors, areas = net(3.0, 20)
    radius = 0.005
    radiance = 10_000.0 / WHITE / (4.0 * np.pi * np.pi * radius**2)
    text = f"void light lit 0 0 3 {radiance} {radiance} {radiance}\nlit sphere lamp 0 0 4 2 2 1.5 {radius}\n"
    value, error = read(text + BLACK + box(3.0, without=""), sensors, samples=64)
    rows = [Row("lamp, lm", float(WHITE * value @ areas), float(WHITE * np.hypot.reduce(error * areas)), 1e4)]
    # The ceiling sees no light: its sensors would lie in the opening.
    inside = np.array([s[5] >= 0.0 for s in sensors])
    chosen = [s for s, keep in zip(sensors, inside, strict=True) if keep]
    for glazed in (False, True):
        text, _opening = roof(1.0, glazed)
        value, error = under(1, (0.0, 0.5, np.sqrt(0.75)), text, chosen, samples=256)
        pane = transmittance if glazed else open_to
        shine = sky(1, np.array((0.0, 0.5, np.sqrt(0.75))))
        exact = 100.0 * horizontal(shine, pane) / horizontal(shine)
        rows.append(
            Row(
                f"roof {'glazed' if glazed else 'open'}, % m2",
                float(value @ areas[inside]),
                float(np.hypot.reduce(error * areas[inside])),
                exact,
            )
        )
    return rows
