"""Scenes rendered by gonio and by RADIANCE: what sensors read, and the mean luminance of a picture."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import gonio
import numpy as np

from .radiance import Radiance
from .scenes import Case

LUMINANCE = 179.0 * np.array([0.265074126, 0.670114631, 0.064811243])
"""RADIANCE's luminous efficacy and weights."""

EXACT = (
    "-aa",
    "0",
    "-as",
    "0",
    "-dt",
    "0",
    "-dj",
    "1",
    "-ds",
    ".02",
    "-dr",
    "2",
    "-dp",
    "0",
    "-st",
    "0",
    "-ss",
    "16",
    "-lw",
    "1e-7",
    "-lr",
    "40",
    "-u+",
)
"""Every point for itself, no light left out, sources sampled at random points, lobes by 16 samples."""

ALLOWED = 0.01
"""Relative difference beside both standard errors."""

LARGEST_ERROR = 0.004
"""Relative standard error above which a program measures again: what is equal differs by more than allowed
with a probability of 1e-3 where both programs come to it, and below 1e-5 for most quantities."""

Quantities = list[tuple[float, float]]
"""Values with their standard errors."""


@dataclass(frozen=True)
class Found:
    """A quantity by both programs, with standard errors: lx for a sensor, cd/m2 for a picture."""

    what: str
    ours: float
    ours_error: float
    theirs: float
    theirs_error: float

    @property
    def difference(self) -> float:
        """Relative to RADIANCE."""
        return self.ours / self.theirs - 1.0

    @property
    def allowed(self) -> float:
        """The difference up to which they agree, relative."""
        return ALLOWED + (self.ours_error + self.theirs_error) / self.theirs

    @property
    def agrees(self) -> bool:
        return abs(self.difference) <= self.allowed


def compare(radiance: Radiance, case: Case, *, effort: float = 1.0) -> list[Found]:
    """Both programs on a scene; `effort` multiplies all numbers of samples."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        case.write(folder)
        (folder / "radiance.oct").write_bytes(radiance.run("oconv", "-f", "scene.rad", cwd=folder))
        scene, warnings = gonio.read_scene(folder / (case.ours or "scene.rad"))
        if warnings:
            raise AssertionError(f"{case.name}: {warnings}")
        sensors, picture = (
            zip(_precise(partial(ours, scene, case), effort), _precise(theirs, effort), strict=True)
            for ours, theirs in (
                (_sensors, partial(_radiance_sensors, radiance, folder, case)),
                (_picture, partial(_radiance_picture, radiance, folder, case)),
            )
        )
    found = [Found(f"sensor {k + 1}", *ours, *theirs) for k, (ours, theirs) in enumerate(sensors)]
    return [*found, *(Found("picture", *ours, *theirs) for ours, theirs in picture)]


def _precise(measure: Callable[[float], Quantities], effort: float) -> Quantities:
    """What is measured, again with more samples while a standard error is above `LARGEST_ERROR`."""
    found = measure(effort)
    for _ in range(3):
        more = max(_more(*one) for one in found)
        if more == 1.0:
            break
        effort *= more
        found = measure(effort)
    return found


def _more(value: float, error: float) -> float:
    """Factor of samples that brings a standard error below `LARGEST_ERROR`; 1 where it is."""
    worst = error / value / LARGEST_ERROR
    return min(1.3 * worst**2, 16.0) if worst > 1.0 else 1.0


def upright(radiance: Radiance, case: Case, *, theta: float, n: int = 4000) -> tuple[float, float]:
    """Radiance of the `aBSDF` of a case under an even sky, seen at an angle: by both programs."""
    rng = np.random.default_rng(1)
    angle, phi = np.radians(theta + rng.uniform(-5, 5, n)), rng.uniform(0, 2 * np.pi, n)
    s, c = np.sin(angle), np.cos(angle)
    towards = np.stack([s * np.cos(phi), s * np.sin(phi), -c], -1)
    text = """void glow g 0 0 4 1 1 1 0
g source sky 0 0 4 0 0 1 360
void aBSDF m 5 m.xml 0 1 0 . 0 0
m polygon p 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0
"""
    even = replace(case, text=text, bounces=1, divisions=4)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        even.write(folder)
        (folder / "radiance.oct").write_bytes(radiance.run("oconv", "-f", "scene.rad", cwd=folder))
        rays = np.concatenate([-towards, towards], 1).astype(np.float32).tobytes()
        theirs = _trace(radiance, folder, even, rays, ["-ff"])
        scene, _ = gonio.read_scene(folder / "scene.rad")
    s, c = np.sin(np.radians(theta)), np.cos(np.radians(theta))
    view = f"-vtv -vp {-s} 0 {c} -vd {s} 0 {-c} -vu 0 1 0 -vh 10 -vv 10"
    picture = gonio.render(scene, view=view, size=16, samples=256, seed=6)
    return float(picture.luminance.mean() / LUMINANCE.sum()), float(theirs.mean() / LUMINANCE.sum())


def _trace(radiance: Radiance, folder: Path, case: Case, rays: bytes, options: Sequence[str]) -> np.ndarray:
    """Luminance or illuminance of each ray."""
    ambient = ["-ab", str(case.bounces), "-ad", str(case.divisions)]
    command = ["rtrace", "-h", *EXACT, *ambient, *case.options, *options, "radiance.oct"]
    out = radiance.run(*command, cwd=folder, stdin=rays)
    return np.frombuffer(out, np.float32).reshape(-1, 3).astype(float) @ LUMINANCE


def _sensors(scene: gonio.Scene, case: Case, effort: float) -> Quantities:
    """Illuminance and its standard error; a sensor that is too uncertain is measured again for itself."""

    def read(sensors: Sequence[tuple[float, ...]], effort: float) -> Quantities:
        samples = int(effort * case.samples)
        lux = gonio.render_sensors(scene, sensors, samples=samples, relative_error=None, seed=5)
        return list(zip(lux.illuminance.tolist(), lux.standard_error.tolist(), strict=True))

    found = read(case.sensors, effort)
    for k, sensor in enumerate(case.sensors):
        grown = effort * _more(*found[k])
        if grown > effort:
            (found[k],) = _precise(partial(read, (sensor,)), grown)
    return found


def _picture(scene: gonio.Scene, case: Case, effort: float) -> Quantities:
    """Mean luminance and its standard error."""
    samples = int(effort * case.pixel_samples)
    picture = gonio.render(scene, view=case.view, size=case.size, samples=samples, seed=6)
    error = np.sqrt((picture.standard_error**2).sum()) / picture.luminance.size
    return [(float(picture.luminance.mean()), float(error))]


def _radiance_sensors(radiance: Radiance, folder: Path, case: Case, effort: float) -> Quantities:
    """Illuminance and its standard error, from the scatter of runs; more of them where it needs them."""

    def read(sensors: Sequence[tuple[float, ...]], repeats: int) -> np.ndarray:
        rows = np.repeat(np.array(sensors, np.float32), repeats, axis=0)
        return _trace(radiance, folder, case, rows.tobytes(), ["-I", "-ff"]).reshape(-1, repeats)

    def told(values: np.ndarray) -> tuple[float, float]:
        return float(values.mean()), float(values.std(ddof=1) / np.sqrt(len(values)))

    found = []
    first = read(case.sensors, max(8, round(effort * case.repeats)))
    for sensor, row in zip(case.sensors, first, strict=True):
        values = row
        for _ in range(3):
            more = math.ceil((_more(*told(values)) - 1.0) * len(values))
            if more == 0:
                break
            values = np.concatenate([values, read((sensor,), more)[0]])
        found.append(told(values))
    return found


def _radiance_picture(radiance: Radiance, folder: Path, case: Case, effort: float) -> Quantities:
    """Mean luminance and its standard error, from the scatter of each pixel's rays."""
    rays = max(2, round(effort * case.pixel_rays))
    size = ["-x", str(case.size), "-y", str(case.size), "-pj", "1", "-c", str(rays)]
    lines = radiance.run("vwrays", "-ff", *case.view.split(), *size, cwd=folder)
    values = _trace(radiance, folder, case, lines, ["-ff", "-ad", str(case.pixel_divisions)])
    values = values.reshape(-1, rays)
    n = len(values)
    error = np.sqrt((values.var(axis=1, ddof=1) / rays).sum()) / n
    return [(float(values.mean()), float(error))]
