"""Pictures and sensors of scenes, by backward path tracing."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gonio import _native
from gonio._native import DomainError, FormatError, RenderWatch, Samples, Scene
from gonio.files import check_file
from gonio.picture_files import PICTURE_SUFFIXES, Picture, write_picture
from gonio.readings import PathLike
from gonio.rendering_state import Job, forget, resume_or_new, save_state, state_path
from gonio.shown_models import model_of_scene
from gonio.working import finishing, interruptible

Array = NDArray[np.float64]

MOST_PIXELS = 2**31
"""More have no numbers of their own."""


@dataclass(frozen=True)
class RenderProgress:
    """How far rendering is.

    `done` is the share of the samples that will be needed, by what is known, `error` the mean standard error
    over the mean luminance (inf at first), `remaining` the seconds to go (None at first).
    """

    done: float
    error: float
    remaining: float | None


Report: TypeAlias = Callable[[RenderProgress], None]
"""Called some twenty times a second."""


def unwatched(progress: RenderProgress) -> None:
    """Progress that nobody watches."""


def read_scene(*files: PathLike, search: Sequence[PathLike] | None = None) -> tuple[Scene, list[str]]:
    """Read a scene of Radiance text, or of YAML (docs/formats/scene-yaml.md).

    Parameters
    ----------
    files
        The files, one after the other as `oconv` takes them: what one names the next may use. Those that end
        in .yaml or .yml are YAML, all others Radiance text.
    search
        Folders in which files are looked for that a scene names, after that of the file that names them. None
        takes those of the environment variable RAYPATH, and without it the working directory.

    Returns
    -------
    Scene, list of str
        The scene, with the view that a YAML file names (`view`, None without), and what it is read without:
        warnings that name file and line.

    Raises
    ------
    DomainError
        No file, or a scene whose parts do not fit together.
    FormatError
        Text that is no scene, materials without a model, a command other than Radiance's generators; the
        message names file and line. No command is ever run by a shell.
    OSError
        No such file.
    """
    _check("files", len(files) > 0, "none", "at least one")
    paths = [Path(f) for f in files]
    folders = ray_path() if search is None else [Path(f) for f in search]
    return interruptible(lambda: _native.read_scene(paths, folders, model=model_of_scene))


def ray_path() -> list[Path]:
    """Folders of Radiance's environment variable RAYPATH; without it the working directory."""
    return [Path(folder) for folder in os.environ.get("RAYPATH", ".").split(os.pathsep) if folder]


def read_sensors(path: PathLike) -> Array:
    """Read sensors: lines of x y z nx ny nz, as `rtrace -I` takes them; blank lines are passed over.

    Returns
    -------
    array of shape (n, 6)

    Raises
    ------
    FormatError
        A line without six finite numbers, or no line.
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
        if len(row) != 6 or not np.isfinite(row).all():
            raise FormatError(
                f"{path}:{number}: sensor: found {line.strip()[:60]!r}, allowed six numbers x y z nx ny nz"
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


def render(
    scene: Scene,
    *,
    view: str | PathLike,
    out: PathLike | None = None,
    size: int | tuple[int, int] = 512,
    samples: int = 256,
    relative_error: float | None = None,
    seed: int = 1,
    bounces: int = 64,
    resume: bool = False,
    threads: int | None = None,
    progress: Report = unwatched,
) -> Picture:
    """Render a picture of a scene.

    The same scene, view, size, samples and seed give the same picture to the last bit, on any number of
    threads and after any interruption.

    Parameters
    ----------
    scene
        What is seen.
    view
        Radiance's view options (`-vtv -vp …`; text that begins with a hyphen), or a view file.
    out
        The file: .exr holds radiance, luminance and its standard error, .hdr is a Radiance picture, .png
        shows luminance in false colours. Without it nothing is written.
    size
        Largest width and height in pixels; pixels are square, so one of them is smaller where the view is not
        as wide as high.
    samples
        Paths a pixel, at most; rounded up to a multiple of 8.
    relative_error
        A pixel is done when the standard error of its luminance is below this fraction of it (of a hundredth
        of the mean luminance where it is darker). Without it all pixels take all samples.
    seed
        Of the random numbers.
    bounces
        Surfaces a path visits at most, 0 for emitted light alone; Radiance's `-ab n` is n + 1.
    resume
        Go on from the samples kept beside `out`, if there are, and keep all samples there. An interruption
        keeps them in any case.
    threads
        All processors without it.
    progress
        Called with how far the work is.

    Raises
    ------
    DomainError
        A size, number of samples or view that does not work, or kept samples of another picture.
    OSError
        The operating system refuses; an older picture stays as it was.
    KeyboardInterrupt
        Ctrl-C; the message names the file of the samples so far.
    """
    target = None if out is None else _checked(out)
    _check_effort(samples=samples, relative_error=relative_error, seed=seed, bounces=bounces, threads=threads)
    width, height = (size, size) if isinstance(size, int) else size
    _check("size", width >= 1 and height >= 1 and width * height <= MOST_PIXELS, size, "1 pixel or more")
    if resume and target is None:
        raise DomainError("resume: found no out, allowed with the file of a picture")
    options, width, height = _native.view_options(view_text(view), width, height)
    _check("size", width >= 1 and height >= 1, f"{width} x {height}", "1 pixel or more at this view")

    def work(into: Samples, watch: RenderWatch, most: int, wanted: float | None) -> None:
        _native.render_picture(
            scene,
            into,
            view=options,
            width=width if into is not probe else 8,
            samples=most,
            relative_error=wanted,
            bounces=bounces,
            seed=seed,
            watch=watch,
            threads=threads,
        )

    probe = Samples(64)
    job = Job(
        kind="picture",
        width=width,
        height=height,
        text=options,
        seed=seed,
        bounces=bounces,
        scene=_fingerprint(probe, work),
    )
    taken = _run(job, work, target, resume=resume, samples=samples, wanted=relative_error, progress=progress)
    picture = Picture(
        radiance=taken.mean().reshape(height, width, 3),
        luminance=taken.luminance().reshape(height, width),
        standard_error=taken.error().reshape(height, width),
        samples=taken.to_arrays()["count"].reshape(height, width),
        view=options,
    )
    if target is not None:
        write_picture(target, picture, taken)
        _tidy(target, job, taken, keep=resume)
    return picture


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
    _check_effort(samples=samples, relative_error=relative_error, seed=seed, bounces=bounces, threads=threads)
    rows = np.atleast_2d(np.asarray(sensors, dtype=np.float64))
    _check("sensors", rows.ndim == 2 and rows.shape[1] == 6, f"shape {rows.shape}", "rows of 6 numbers")
    _check("sensors", len(rows) > 0, "none", "at least one")
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
        scene=_fingerprint(probe, work),
    )
    taken = _run(job, work, target, resume=resume, samples=samples, wanted=relative_error, progress=progress)
    if target is not None:
        _tidy(target, job, taken, keep=resume)
    return SensorReadings(taken.mean(), taken.luminance(), taken.error(), taken.to_arrays()["count"])


def view_text(view: str | PathLike) -> str:
    """View options: the text itself where it begins with a hyphen, else those of the file.

    Raises
    ------
    FormatError, OSError
        No view in the file; no such file.
    """
    if isinstance(view, str) and view.lstrip().startswith("-"):
        return view
    return _native.read_view(view)


Work: TypeAlias = Callable[[Samples, RenderWatch, int, float | None], None]


def _fingerprint(probe: Samples, work: Work) -> bytes:
    """What a few paths of the scene bring: another scene brings something else."""
    work(probe, RenderWatch(), 16, None)
    sums: bytes = probe.to_arrays()["sum"].tobytes()
    return sums


def _run(
    job: Job,
    work: Work,
    target: Path | None,
    *,
    resume: bool,
    samples: int,
    wanted: float | None,
    progress: Report,
) -> Samples:
    taken = resume_or_new(target, job, resume=resume)
    watch = RenderWatch()
    start = time.monotonic()
    first: float | None = None

    def tick() -> None:
        nonlocal first
        done, error = watch.progress()
        if done <= 0.0:
            return
        first = done if first is None else first
        gained = done - first
        spent = time.monotonic() - start
        left = spent * (1.0 - done) / gained if gained > 0.0 else None
        progress(RenderProgress(done, error, left))

    stopped = finishing(lambda: work(taken, watch, samples, wanted), tick=tick, stop=watch.stop)
    if stopped is not None:
        if target is not None and isinstance(stopped, KeyboardInterrupt):
            save_state(target, job, taken)
            raise KeyboardInterrupt(
                f"{state_path(target)} keeps the samples so far; resume=True (--resume) goes on"
            ) from stopped
        raise stopped
    return taken


def _tidy(target: Path, job: Job, taken: Samples, *, keep: bool) -> None:
    if keep:
        save_state(target, job, taken)
    else:
        forget(target)


def _checked(out: PathLike) -> Path:
    target = check_file(out)
    suffix = target.suffix
    if suffix not in PICTURE_SUFFIXES:
        raise DomainError(f"out: found the ending {suffix!r}, allowed {', '.join(PICTURE_SUFFIXES)}")
    return target


def _check_effort(
    *, samples: int, relative_error: float | None, seed: int, bounces: int, threads: int | None
) -> None:
    _check("samples", 1 <= samples < 2**31, samples, "1 to 2147483647")
    wanted = relative_error is None or 0.0 < relative_error < 1.0
    _check("relative_error", wanted, relative_error, "above 0 and below 1, or None")
    _check("seed", 0 <= seed < 2**64, seed, "0 to 2^64 - 1")
    _check("bounces", 0 <= bounces < 2**32, bounces, "0 or more")
    _check("threads", threads is None or threads >= 1, threads, "1 or more")


def _check(field: str, good: bool, found: object, allowed: str) -> None:
    if not good:
        raise DomainError(f"{field}: found {found}, allowed {allowed}")
