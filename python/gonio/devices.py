"""The BSDF of parts that exist as geometry: blinds, films, fabrics, rough surfaces."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from gonio import _native
from gonio._native import Device, DomainError, Klems, RenderWatch, TensorTree
from gonio.files import check_file
from gonio.readings import PathLike
from gonio.rendering import ray_path
from gonio.shown_models import model_of_scene
from gonio.working import Progress, interruptible, silent

Array = NDArray[np.float64]
T = TypeVar("T")

RANKS = {"ttree3": 3, "ttree4": 4}
BASES = ("full", "half", "quarter", *RANKS)
SIDES = ("front", "back")

FIRST_RAYS = 512
"""Rays from each patch by which is found how many an error needs."""

FIRST_RAYS_OF_A_CELL = 64
"""The same for the cells of tensor trees."""

MOST_STEP = 8.0
"""Rays of a tensor tree are not multiplied by more at once: cells that split make its error fall slower."""

MOST_RAYS = 2**22
"""Rays from each patch, at most."""

FAINT = 1e-3
"""A component with less than this share of the light does not decide how many rays there are."""


@dataclass(frozen=True)
class PatchMeans:
    """Means over pairs of Klems patches for light that arrives on one side, and one component.

    `values` are BSDF in 1/sr, [exit, incident, red green blue], `errors` the standard errors of their
    luminance, [exit, incident], from the scatter of 16 independent sets of rays: of a pair that no ray has
    met it is 0, and less light than a ray carries may be there.
    """

    values: Array
    errors: Array

    @property
    def luminance(self) -> Array:
        """BSDF of the luminance, 1/sr, [exit, incident]."""
        weights = np.array([47.448246, 119.950585, 11.601169])
        return np.asarray(self.values @ (weights / weights.sum()))


@dataclass(frozen=True)
class GeometryBsdf:
    """BSDF of a part as Klems matrices or tensor trees.

    Attributes
    ----------
    model
        A model of the luminance, for everything that takes a BSDF.
    standard_error
        The standard error of every value of `model`, 1/sr, as a model of the same patches or cells: its
        `eval` at a pair of directions is the error of `model.eval` there.
    means
        By (side of incidence, component): means over pairs of Klems patches with standard errors; nothing of
        trees.
    basis
        "full", "half", "quarter", "ttree3" or "ttree4".
    rays
        Rays that were sent from each patch (incident cell) and side.
    relative_error
        By (side of incidence, component): root mean square of the standard errors over the mean BSDF, all
        pairs weighted by their projected solid angles. Of trees the deviations that merging cells makes are
        in it, as estimated from values and errors [Stein1981].
    window
        The rectangle that rays were sent through.
    warnings
        What the geometry is read without.
    """

    model: Klems | TensorTree
    standard_error: Klems | TensorTree
    means: dict[tuple[str, str], PatchMeans] = field(repr=False)
    basis: str
    rays: int
    relative_error: dict[tuple[str, str], float]
    window: tuple[float, float, float, float]
    warnings: list[str] = field(default_factory=list)

    @property
    def cells(self) -> int | None:
        """Number of cells of a tensor tree's components; None of Klems matrices."""
        return self.model.cells if isinstance(self.model, TensorTree) else None

    def albedo(self, *, side: str, component: str) -> float:
        """Reflectance or transmittance of light that arrives at right angles on a side."""
        if isinstance(self.model, TensorTree):
            return self.model.albedo(theta_i=0.0 if side == "front" else 180.0, component=component)
        return float(self.model.albedo(side=side, component=component)[0])

    def write(self, path: str | os.PathLike[str], *, name: str = "") -> None:
        """Write Radiance BSDF XML; the file appears whole or not at all."""
        check_file(path)
        _native.write_radiance_xml(path, self.model, name=name)


def simulate_geometry(
    *files: PathLike,
    window: Sequence[float] | None = None,
    periodic: bool = False,
    basis: str = "full",
    levels: int = 5,
    tolerance: float = 0.01,
    max_cells: int = 200_000,
    sides: Sequence[str] = SIDES,
    error: float = 0.05,
    rays: int | None = None,
    bounces: int = 1024,
    seed: int = 1,
    search: Sequence[PathLike] | None = None,
    progress: Progress = silent,
) -> GeometryBsdf:
    """BSDF of a part that is geometry with materials, by rays through it from all directions.

    The part lies about the plane z = 0, its front is +z. Rays are followed from evenly spread points of the
    window and directions of each patch; where they leave is sorted by patches. Every pair of patches is seen
    from both ends, which is one value by Helmholtz reciprocity [Veach1997, sec. 5.2]. The values are of the
    light that falls on the window, wherever it leaves a part that does not repeat.

    Parameters
    ----------
    files
        Scene files, as `read_scene` takes them; lamps and skies in them are left out.
    window
        x_low, y_low, x_high, y_high of the rectangle that rays are sent through, in the unit of the
        geometry. None takes all of it.
    periodic
        Whether the window is one period of a part that goes on beyond it. Without, rays leave at its rim.
    basis
        Klems patches: full (145), half (77) or quarter (41). Cells of tensor trees: ttree4, or ttree3 of a
        part that scatters alike at all azimuths of incidence; of another it is the average over them.
    levels
        Finest cells of a tree have the side 2**-levels of the square of direction cosines, 2 to 6. Rank 4
        takes 80 MB at 5, 1.2 GB at 6. Cells that agree within their errors are one.
    tolerance
        Cells of a tree that differ more are merged too, the most alike first, until the differences add up to
        this share of the light of a component, 0 to 1.
    max_cells
        And until each component has no more cells than this, at least 16.
    sides
        Sides that rays are sent from: "front", "back". From one side, reflection there and transmission
        both ways are known (of a part that does not repeat, that of light from the other side is of what
        leaves through the window); both sides halve the variance of the transmission.
    error
        Relative error of what is asked (`GeometryBsdf.relative_error`): more rays are sent until it is met,
        or there are 4 million a patch.
    rays
        Rays from each patch, rounded up to sixteen times 4, 5, 6 or 7 times a power of two; `error` does not
        count then.
    bounces
        Reflections and transmissions that a ray is followed through, at most: light in a film is guided far.
    seed
        Seed of the numbers; the same gives the same values on any number of threads.
    search
        Folders, as for `read_scene`.
    progress
        Called with a stage and how far it is.

    Returns
    -------
    GeometryBsdf

    Raises
    ------
    DomainError
        A parameter outside its range, a part without extent in x or y, a window outside it.
    FormatError, OSError
        As `read_scene`.
    """
    _check("basis", basis in BASES, basis, ", ".join(BASES))
    _check("sides", len(sides) > 0 and set(sides) <= set(SIDES), ", ".join(sides) or "none", "front, back")
    _check("error", 0 < error < math.inf, error, "above 0")
    _check("bounces", 1 <= bounces <= 2**31, bounces, "1 to 2**31")
    _check("rays", rays is None or 1 <= rays <= MOST_RAYS, rays, f"1 to {MOST_RAYS}")
    _check("seed", 0 <= seed < 2**64, seed, "0 to 2**64 - 1")
    _check("levels", 2 <= levels <= 6, levels, "2 to 6")
    _check("tolerance", 0 <= tolerance <= 1, tolerance, "0 to 1")
    _check("max_cells", 16 <= max_cells < 2**32, max_cells, "16 to 2**32 - 1")
    device, warnings = open_device(files, window=window, periodic=periodic, search=search)

    def followed(count: int, follow: Callable[..., T], **more: Any) -> T:
        watch = RenderWatch()
        return interruptible(
            lambda: follow(
                rays=count,
                front="front" in sides,
                back="back" in sides,
                bounces=bounces,
                seed=seed,
                watch=watch,
                **more,
            ),
            tick=lambda: progress("rays", int(1000 * watch.progress()[0]), 1000),
            stop=watch.stop,
        )

    def measured(count: int) -> tuple[GeometryBsdf, float]:
        box = _window(device)
        if basis in RANKS:
            cells = {"levels": levels, "tolerance": tolerance, "max_cells": max_cells}
            tree, deviation, stated = followed(count, device.trees, rank=RANKS[basis], **cells)
            mean = {key: row[0] for key, row in stated.items()}
            errors, most = _relative(mean, {key: row[1] for key, row in stated.items()})
            return GeometryBsdf(tree, deviation, {}, basis, count, errors, box, warnings), most
        model, deviations, arrays = followed(count, device.patches, basis=basis)
        means = {key: PatchMeans(*pair) for key, pair in arrays.items()}
        errors, most = _relative_errors(means, _solid_angles(model, means))
        return GeometryBsdf(model, deviations, means, basis, count, errors, box, warnings), most

    if rays is not None:
        return measured(_native.rounded_rays(rays))[0]
    count, step = (FIRST_RAYS_OF_A_CELL, MOST_STEP) if basis in RANKS else (FIRST_RAYS, math.inf)
    while True:
        found, most = measured(count)
        if most <= error:
            return found
        if count >= MOST_RAYS:
            text = f"error: reached {100 * most:.2g} % with the most rays, {100 * error:g} % were asked for"
            return replace(found, warnings=[*found.warnings, text])
        # The error falls at least with the square root of the rays; it is known to some percent.
        wanted = min(count * min(max(1.5, 1.1 * (most / error) ** 2), step), MOST_RAYS)
        count = _native.rounded_rays(math.ceil(wanted))


def open_device(
    files: Sequence[PathLike],
    *,
    window: Sequence[float] | None,
    periodic: bool,
    search: Sequence[PathLike] | None,
) -> tuple[Device, list[str]]:
    """The part that is in files, and what it is read without; as `simulate_geometry` says."""
    _check("files", len(files) > 0, "none", "at least one")
    good = window is None or (len(window) == 4 and all(math.isfinite(x) for x in window))
    _check("window", good, window, "x_low, y_low, x_high, y_high")
    paths = [Path(f) for f in files]
    folders = ray_path() if search is None else [Path(f) for f in search]
    bounds = None if window is None else [float(x) for x in window]
    return interruptible(
        lambda: _native.read_device(paths, folders, model=model_of_scene, window=bounds, periodic=periodic)
    )


def _window(device: Device) -> tuple[float, float, float, float]:
    x_low, y_low, x_high, y_high = device.window
    return (x_low, y_low, x_high, y_high)


def _solid_angles(model: Klems, means: dict[tuple[str, str], PatchMeans]) -> Array:
    """Projected solid angle of each patch, sr."""
    side, component = next(iter(means))
    name = model.bases(side=side, component=component)[0]
    return np.asarray(_native.klems_solid_angles(name))


def _relative_errors(
    means: dict[tuple[str, str], PatchMeans], solid_angle: Array
) -> tuple[dict[tuple[str, str], float], float]:
    """Relative error of each component, and the largest of those that are not faint."""
    weights = np.outer(solid_angle, solid_angle) / math.pi**2
    mean = {key: float((m.luminance * weights).sum()) for key, m in means.items()}
    return _relative(mean, {key: math.sqrt(float((m.errors**2 * weights).sum())) for key, m in means.items()})


def _relative(
    mean: dict[tuple[str, str], float], error: dict[tuple[str, str], float]
) -> tuple[dict[tuple[str, str], float], float]:
    """Errors over means, and the largest of components that are not faint."""
    relative = {key: error[key] / mean[key] if mean[key] > 0 else 0.0 for key in mean}
    total = max(mean.values())
    bright = [relative[key] for key in mean if mean[key] > FAINT * total]
    return relative, max(bright, default=0.0)


def _check(name: str, good: bool, found: object, allowed: str) -> None:
    if not good:
        raise DomainError(f"{name}: found {found}, allowed {allowed}")
