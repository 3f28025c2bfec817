"""Pictures of scenes, by backward path tracing."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from gonio import _native
from gonio._native import DomainError, RenderWatch, Samples, Scene
from gonio.files import check_file
from gonio.picture_files import PICTURE_SUFFIXES, Picture, write_picture
from gonio.readings import PathLike
from gonio.rendering_runs import Report, check, check_effort, fingerprint, run, tidy, unwatched
from gonio.rendering_state import Job
from gonio.shown_models import model_of_scene
from gonio.working import interruptible

MOST_PIXELS = 2**31
"""More have no numbers of their own."""


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
    check("files", len(files) > 0, "none", "at least one")
    paths = [Path(f) for f in files]
    folders = ray_path() if search is None else [Path(f) for f in search]
    return interruptible(lambda: _native.read_scene(paths, folders, model=model_of_scene))


def ray_path() -> list[Path]:
    """Folders of Radiance's environment variable RAYPATH; without it the working directory."""
    return [Path(folder) for folder in os.environ.get("RAYPATH", ".").split(os.pathsep) if folder]


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
    colours: tuple[float, float] | None = None,
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
    colours
        Ends of the false colours of a .png, cd/m2, as `false_colour` takes them.
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
    check_effort(samples=samples, relative_error=relative_error, seed=seed, bounces=bounces, threads=threads)
    check(
        "colours",
        colours is None or 0.0 < colours[0] < colours[1] < float("inf"),
        colours,
        "0 < low < high, or None",
    )
    width, height = (size, size) if isinstance(size, int) else size
    check("size", width >= 1 and height >= 1 and width * height <= MOST_PIXELS, size, "1 pixel or more")
    if resume and target is None:
        raise DomainError("resume: found no out, allowed with the file of a picture")
    options, width, height = _native.view_options(view_text(view), width, height)
    check("size", width >= 1 and height >= 1, f"{width} x {height}", "1 pixel or more at this view")

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
        scene=fingerprint(probe, work),
    )
    taken = run(job, work, target, resume=resume, samples=samples, wanted=relative_error, progress=progress)
    picture = Picture(
        radiance=taken.mean().reshape(height, width, 3),
        luminance=taken.luminance().reshape(height, width),
        standard_error=taken.error().reshape(height, width),
        samples=taken.to_arrays()["count"].reshape(height, width),
        view=options,
    )
    if target is not None:
        write_picture(target, picture, taken, colours=colours)
        tidy(target, job, taken, keep=resume)
    return picture


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


def _checked(out: PathLike) -> Path:
    target = check_file(out)
    suffix = target.suffix
    if suffix not in PICTURE_SUFFIXES:
        raise DomainError(f"out: found the ending {suffix!r}, allowed {', '.join(PICTURE_SUFFIXES)}")
    return target
