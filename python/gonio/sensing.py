"""Irradiance at points of scenes, by backward path tracing."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gonio import _native
from gonio._native import DomainError, FormatError, RenderWatch, Samples, Scene
from gonio.files import check_file
from gonio.readings import PathLike
from gonio.rendering_runs import Report, check, check_effort, fingerprint, run, tidy, unwatched
from gonio.rendering_state import Job

Array = NDArray[np.float64]


def read_sensors(path: PathLike) -> Array:
    """Read sensors: lines of x y z nx ny nz, as `rtrace -I` takes them; blank lines are passed over.

    Returns
    -------
    array of shape (n, 6)

    Raises
    ------
    FormatError
        A line without six finite numbers, a normal of no length, or no line.
    OSError
        The operating system refuses.
    """
    rows = []
    text = Path(path).read_text(encoding="utf-8", errors="replace")
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        if not words:
            continue
        try:
            row = [float(word) for word in words]
        except ValueError:
            row = []
        if len(row) != 6 or not np.isfinite(row).all() or not any(row[3:]):
            raise FormatError(
                f"{path}:{number}: sensor: found {line.strip()[:60]!r}, allowed six numbers x y z nx ny nz, "
                "the normal of some length"
            )
        rows.append(row)
    if not rows:
        raise FormatError(f"{path}: found no sensor, allowed lines of x y z nx ny nz")
    return np.array(rows)


@dataclass(frozen=True)
class SensorReadings:
    """What sensors read, one row each.

    `irradiance` is red, green and blue in W/m2, shape (n, 3); `illuminance` and its `standard_error` are lux;
    `samples` the number of paths.
    """

    irradiance: Array
    illuminance: Array
    standard_error: Array
    samples: NDArray[np.uint32]


def render_sensors(
    scene: Scene,
    sensors: ArrayLike,
    *,
    samples: int = 1 << 16,
    relative_error: float | None = 0.01,
    seed: int = 1,
    bounces: int = 64,
    state: PathLike | None = None,
    resume: bool = False,
    threads: int | None = None,
    progress: Report = unwatched,
) -> SensorReadings:
    """Return the irradiance and illuminance at points.

    Parameters
    ----------
    scene
        What lights them.
    sensors
        Rows of x, y, z and the normal nx, ny, nz (of any length), as `rtrace -I` takes them.
    samples
        Paths a sensor, at most; rounded up to a multiple of 8.
    relative_error
        A sensor is done when the standard error of its illuminance is below this fraction of it (of a
        hundredth of the mean illuminance where it is darker). None: all take all samples.
    seed
        Of the random numbers.
    bounces
        Surfaces a path visits at most, the sensor among them: 1 is light straight from the sources,
        `rtrace -I -ab n` is n + 1.
    state
        The file of the result, beside which samples are kept on an interruption.
    resume
        Go on from the samples kept beside `state`, and keep them.
    threads, progress
        As `render`.

    Raises
    ------
    DomainError
        Rows of another length, a point that is not finite, a normal of no length.
    KeyboardInterrupt
        Ctrl-C.
    """
    check_effort(samples=samples, relative_error=relative_error, seed=seed, bounces=bounces, threads=threads)
    rows = np.atleast_2d(np.asarray(sensors, dtype=np.float64))
    check("sensors", rows.ndim == 2 and rows.shape[1] == 6, f"shape {rows.shape}", "rows of 6 numbers")
    check("sensors", len(rows) > 0, "none", "at least one")
    if resume and state is None:
        raise DomainError("resume: found no state, allowed with the file of the result")

    def work(into: Samples, watch: RenderWatch, most: int, wanted: float | None) -> None:
        _native.render_sensors(
            scene,
            into,
            sensors=rows if into is not probe else rows[:64],
            samples=most,
            relative_error=wanted,
            bounces=bounces,
            seed=seed,
            watch=watch,
            threads=threads,
        )

    probe = Samples(min(len(rows), 64))
    target = None if state is None else check_file(state)
    job = Job(
        kind="sensors",
        width=len(rows),
        height=1,
        text=repr(rows.tolist()),
        seed=seed,
        bounces=bounces,
        scene=fingerprint(probe, work),
    )
    taken = run(job, work, target, resume=resume, samples=samples, wanted=relative_error, progress=progress)
    if target is not None:
        tidy(target, job, taken, keep=resume)
    return SensorReadings(taken.mean(), taken.luminance(), taken.error(), taken.to_arrays()["count"])
