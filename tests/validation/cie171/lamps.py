"""Cases 5.2, 5.3 and 5.5 to 5.8: lamps, a pane, reflecting surfaces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from . import printed
from .exact import Rectangle, configuration_factor, transmittance
from .rooms import (
    BLACK,
    DOWN,
    FLOOR,
    MIDDLES,
    UP,
    WALL,
    WHITE,
    Effort,
    Row,
    box,
    corners,
    net,
    over,
    polygon,
    read,
    table,
)


def point_light(_: Effort) -> list[Row]:
    """5.2: a lamp of 1000 cd 3 m above a floor: a disc of 4 cm, and a ball of 2 cm."""
    places = [
        (0, 0),
        (0.5, 0),
        (1, 0),
        (1.5, 0),
        (0.5, 0.5),
        (1, 0.5),
        (1.5, 0.5),
        (1, 1),
        (1.5, 1),
        (1.5, 1.5),
    ]
    sensors = [[x, y, 0, *UP] for x, y in places]
    squared = np.array([x * x + y * y + 9.0 for x, y in places])
    rows = []
    for radius, shape, exact, prints in (
        (0.02, "ring lamp 0 0 8 0 0 3 0 0 -1 0 .02", 1000.0 * 9.0 / squared**2, printed.TABLE_11),
        (0.01, "sphere lamp 0 0 4 0 0 3 .01", 1000.0 * 3.0 / squared**1.5, None),
    ):
        radiance = 1000.0 / WHITE / (np.pi * radius**2)
        text = f"void light lit 0 0 3 {radiance} {radiance} {radiance}\nlit {shape}\n"
        value, error = read(text, sensors, samples=1024, bounces=1)
        names = [f"{shape.split()[0]}, {c}" for c in "ABCDEFGHIJ"]
        rows += table(names, (WHITE * value, WHITE * error), exact, prints)
    return rows


def area_lamp() -> tuple[str, Rectangle]:
    """The black room with a diffuse lamp of 1 m x 1 m and 1000 cd in the middle of its ceiling."""
    lamp: Rectangle = ([1.5, 1.5, 3.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0])
    radiance = 1000.0 / WHITE
    text = f"void light lit 0 0 3 {radiance} {radiance} {radiance}\n" + polygon("lit", "lamp", corners(lamp))
    return BLACK + box(3.0, without="top") + text, lamp


def area_light(_: Effort) -> list[Row]:
    """5.3: the light of that lamp on a wall and the floor."""
    text, lamp = area_lamp()
    value, error = read(text, WALL + FLOOR, samples=4096)
    exact = [1000.0 * np.pi * configuration_factor(corners(lamp), p, n) for p, n in over(WALL + FLOOR)]
    return table("ABCDEFGHIJKLMN", (WHITE * value, WHITE * error), exact, printed.TABLE_12)


def glass(_: Effort) -> list[Row]:
    """5.5: what a pane leaves of parallel light, by its angle."""
    rows = []
    for degrees in (0, 10, 20, 30, 40, 50, 60, 70, 80, 85):
        angle = np.radians(degrees)
        sun = f"void light sun 0 0 3 1e6 1e6 1e6\nsun source s 0 0 4 0 {np.sin(angle)} {np.cos(angle)} .1\n"
        pane = f"void glass pane 0 0 3 {TRANSMISSIVITY_TEXT}\n" + polygon(
            "pane", "p", [[-50, -50, 1], [50, -50, 1], [50, 50, 1], [-50, 50, 1]]
        )
        (with_pane, error), (bare, _) = (
            read(t, [[0, 0, 0, *UP]], samples=1024, bounces=1) for t in (sun + pane, sun)
        )
        share = with_pane / bare
        exact = transmittance(np.array(np.cos(angle)))
        rows += table([f"{degrees} deg"], (share, error / bare), [float(exact)])
    return rows


TRANSMISSIVITY_TEXT = ".96 .96 .96"


def sunlit(direction: Sequence[float]) -> tuple[str, float]:
    """A sun half a degree wide towards a direction, and its irradiance on a plane that faces it."""
    x, y, z = direction
    # The disc's cosines average to its projected solid angle.
    facing = 1e6 * np.pi * np.sin(np.radians(0.25)) ** 2
    return f"void light sun 0 0 3 1e6 1e6 1e6\nsun source s 0 0 4 {x} {y} {z} .5\n", float(facing)


def reflection(_: Effort) -> list[Row]:
    """5.6: a lit floor of reflectance 0.3 seen by a wall and by a ceiling, as a share of what leaves it."""
    sun, facing = sunlit((0.0, -np.sin(np.radians(35.0)), np.cos(np.radians(35.0))))
    leaving = 0.3 * facing * np.cos(np.radians(35.0))
    wall = [[2.0, 0.0, z, 0.0, 1.0, 0.0] for z in (0.75, 1.25, 1.75, 2.25, 2.75)]
    ceiling = [[2.0, y, 3.0, *DOWN] for y in MIDDLES]
    rows = []
    for side, samples, prints in (
        (0.5, 1 << 18, None),
        (4.0, 1 << 15, printed.TABLE_17),
        (500.0, 1 << 14, None),
    ):
        low = 2.0 - side / 2.0
        floor: Rectangle = ([low, low, 0.0], [side, 0.0, 0.0], [0.0, side, 0.0])
        text = sun + "void plastic grey 0 0 5 .3 .3 .3 0 0\n" + polygon("grey", "floor", corners(floor))
        value, error = read(text, wall + ceiling, samples=samples, bounces=2)
        # The wall sees what lies in front of it, y > 0.
        front: Rectangle = (
            [low, max(low, 0.0), 0.0],
            [side, 0.0, 0.0],
            [0.0, low + side - max(low, 0.0), 0.0],
        )
        exact = [100.0 * configuration_factor(corners(front), p, n) for p, n in over(wall)]
        exact += [100.0 * configuration_factor(corners(floor), p, n) for p, n in over(ceiling)]
        names = [f"{side:g} m, {c}" for c in "BCDEFGHIJKLMN"]
        rows += table(names, (100.0 * value / leaving, 100.0 * error / leaving), exact, prints)
    return rows


def obstruction(_: Effort) -> list[Row]:
    """5.7: a lit wall of reflectance 0.6 behind a block 1 m high, seen by the opposite wall and the floor."""
    sun, facing = sunlit((0.0, -0.5, np.sqrt(0.75)))
    leaving = 0.6 * facing * 0.5
    text = sun + "void plastic grey 0 0 5 .6 .6 .6 0 0\n" + BLACK
    text += polygon("grey", "lit", [[0, 4, 0], [4, 4, 0], [4, 4, 3], [0, 4, 3]])
    # A roof far up keeps the sun from the floor but not from the wall.
    text += polygon("black", "roof", [[-10, -10, 6], [14, -10, 6], [14, 0.3, 6], [-10, 0.3, 6]])
    for name, plane in (
        ("front", [[0, 2.5, 0], [4, 2.5, 0], [4, 2.5, 1], [0, 2.5, 1]]),
        ("back", [[0, 2.7, 0], [4, 2.7, 0], [4, 2.7, 1], [0, 2.7, 1]]),
        ("above", [[0, 2.5, 1], [4, 2.5, 1], [4, 2.7, 1], [0, 2.7, 1]]),
    ):
        text += polygon("black", name, plane)
    sensors = WALL + FLOOR[:5]
    value, error = read(text, sensors, samples=1 << 16, bounces=2)
    exact = []
    for p, n in over(sensors):
        # Both upper edges of the block hide the wall up to a height.
        low = max(p[2] + (1.0 - p[2]) * (4.0 - p[1]) / (edge - p[1]) for edge in (2.5, 2.7))
        seen: Rectangle = ([0.0, 4.0, max(low, 0.0)], [4.0, 0.0, 0.0], [0.0, 0.0, 3.0 - max(low, 0.0)])
        exact.append(100.0 * configuration_factor(corners(seen), p, n) if low < 3.0 else 0.0)
    return table("ABCDEFGHIJK", (100.0 * value / leaving, 100.0 * error / leaving), exact)


def interreflection(_: Effort) -> list[Row]:
    """5.8: mean of what a lamp of 10 000 lm in the middle of a cube brings to its walls by reflection."""
    sensors = [s for s in net(4.0, 12)[0] if s[5] > 0.0]
    weights = net(4.0, 12)[1][: len(sensors)] / 16.0
    radius = 0.005
    radiance = 10_000.0 / WHITE / (4.0 * np.pi * np.pi * radius**2)
    rows = []
    for rho, prints in printed.TABLE_20.items():
        text = (
            f"void light lit 0 0 3 {radiance} {radiance} {radiance}\nlit sphere lamp 0 0 4 2 2 2 {radius}\n"
        )
        text += f"void plastic black 0 0 5 {rho} {rho} {rho} 0 0\n" + box(4.0, without="")
        value, error = read(text, sensors, samples=256, bounces=600)
        mean = float(WHITE * value @ weights) - 1e4 / 96.0
        spread = float(WHITE * np.hypot.reduce(error * weights))
        rows.append(Row(f"reflectance {rho:g}, lx", mean, spread, 1e4 / 96.0 * rho / (1.0 - rho), prints))
    return rows
