"""Whether the standard errors that gonio states are true, and what stopping by them does to the mean."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import gonio
import numpy as np
from numpy.typing import NDArray
from scipy import stats

from .cie171.daylight import FAR_WALL, FROM_AFAR, facade, outside, under
from .cie171.exact import configuration_factor, horizontal, sky, transmittance
from .cie171.lamps import area_lamp
from .cie171.rooms import FLOOR, WALL, corners, over, read
from .mitsuba_pictures import TWINS

Array = NDArray[np.float64]
BATCH = 8
"""Paths of a batch, of which gonio's error is the scatter."""
SUN = (0.0, -0.5, np.sqrt(0.75))
SIDE = 16
"""Pixels on a side of the pictures."""


@dataclass(frozen=True)
class Coverage:
    """How often the truth lies in the stated intervals; errors are root mean squares over the seeds."""

    within_68: float
    within_95: float
    ratio: float
    """Stated error over the true one, median of the places."""
    true: float
    """True relative error, root mean square of the places."""


def coverage(found: Array, stated: Array, truth: Array, samples: int) -> Coverage:
    """Of values by seed and place; intervals are those of Student's t with one degree less than batches."""
    freedom = samples // BATCH - 1
    lit = (stated > 0.0).all(axis=0)
    off, stated = np.abs(found - truth)[:, lit], stated[:, lit]
    one, two = (stats.t.ppf(0.5 + 0.5 * share, freedom) for share in (0.6827, 0.9545))
    true = np.sqrt((off**2).mean(axis=0))
    ratio = np.sqrt((stated**2).mean(axis=0)) / true
    return Coverage(
        within_68=float((off <= one * stated).mean()),
        within_95=float((off <= two * stated).mean()),
        ratio=float(np.median(ratio)),
        true=float(np.sqrt(((true / truth[lit]) ** 2).mean())),
    )


def slope(samples: list[int], errors: list[float], draws: int) -> tuple[float, float]:
    """Slope of ln error over ln samples and its standard error, each error being of `draws` normal ones."""
    x = np.log(samples)
    x -= x.mean()
    return float(x @ np.log(errors) / (x @ x)), float(1.0 / np.sqrt(2.0 * draws * (x @ x)))


def cornell(samples: int, seeds: range, relative_error: float | None = None) -> tuple[Array, Array]:
    """Luminances of pictures of the Cornell box and their stated errors, by seed."""
    scene, view = TWINS[0].ours()
    options: dict[str, Any] = {
        "view": view,
        "size": SIDE,
        "samples": samples,
        "relative_error": relative_error,
    }
    pictures = [gonio.render(scene, seed=seed, **options) for seed in seeds]
    lit = [(p.luminance.ravel(), p.standard_error.ravel()) for p in pictures]
    return np.array([a for a, _ in lit]), np.array([b for _, b in lit])


def cornell_truth(paths: int) -> Array:
    """The same with many paths of other seeds."""
    return cornell(paths, range(10_001, 10_009))[0].mean(axis=0)


def lamp(samples: int, seeds: range) -> tuple[Array, Array, Array]:
    """Sensors under the lamp of case 5.3 of CIE 171, straight light alone, and the exact values."""
    text, rectangle = area_lamp()
    found = [read(text, WALL + FLOOR, samples=samples, seed=seed) for seed in seeds]
    radiance = 1000.0 / 179.0
    exact = [np.pi * radiance * configuration_factor(corners(rectangle), p, n) for p, n in over(WALL + FLOOR)]
    return np.array([f[0] for f in found]), np.array([f[1] for f in found]), np.array(exact)


def window(samples: int, seeds: range) -> tuple[Array, Array, Array]:
    """Sensors behind the glazed facade of case 5.12 under the clear sky, and the exact values."""
    text, opening = facade(2.0, glazed=True)
    sensors = FAR_WALL + FROM_AFAR
    found = [under(12, SUN, text, sensors, samples=samples, seed=seed) for seed in seeds]
    level = horizontal(sky(12, np.array(SUN)))
    exact = [outside(opening, p, n, 12, transmittance, level=level) for p, n in over(sensors)]
    return np.array([f[0] for f in found]), np.array([f[1] for f in found]), np.array(exact)


def stopping_bias(relative_error: float, seeds: range, truth: Array) -> tuple[float, float, float]:
    """Bias of a picture that stops by its error, over the mean; its standard error; paths a pixel."""
    scene, view = TWINS[0].ours()
    options: dict[str, Any] = {
        "view": view,
        "size": SIDE,
        "samples": 1 << 14,
        "relative_error": relative_error,
    }
    pictures = [gonio.render(scene, seed=seed, **options) for seed in seeds]
    off = np.array([p.luminance.mean() for p in pictures]) / truth.mean() - 1.0
    paths = float(np.mean([p.samples.mean() for p in pictures]))
    return float(off.mean()), float(off.std(ddof=1) / np.sqrt(len(off))), paths
