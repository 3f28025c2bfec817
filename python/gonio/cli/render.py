"""`gonio render`: pictures of scenes and materials, irradiance at points."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn

import gonio
from gonio.cli.running import Json, err, out, print_json, warn
from gonio.files import replacing_file
from gonio.materials import MATERIALS
from gonio.picture_files import PICTURE_SUFFIXES
from gonio.rendering_runs import RenderProgress, Report


def render(
    scene: Annotated[
        list[Path] | None,
        typer.Argument(metavar="SCENE", help="Scene files, in order: Radiance text, .yaml."),
    ] = None,
    view: Annotated[
        str | None,
        typer.Option(
            "--view", help="View file, or Radiance's view options as one text. A .yaml may name its own."
        ),
    ] = None,
    sensors: Annotated[
        Path | None,
        typer.Option("--sensors", help="File of lines x y z nx ny nz, as of rtrace -I."),
    ] = None,
    preview: Annotated[
        str | None,
        typer.Option(
            "--preview",
            metavar="MATERIAL",
            help="A ball of a material in place of a scene: a file (XML, RGL, MERL, .rad, compact, "
            f"fit.json), a directory of gonio fit or gonio process, or {', '.join(MATERIALS)}.",
        ),
    ] = None,
    to: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--out",
            help=".exr, .hdr: radiances; .png: false colours (--preview: for the eye). Of --sensors: text.",
        ),
    ] = None,
    size: Annotated[
        str | None, typer.Option(metavar="PIXELS|WxH", help="Largest width and height. Without it 512.")
    ] = None,
    samples: Annotated[
        int | None,
        typer.Option(help="Paths a pixel or sensor, at most, in eights. Without it 256; sensors 65536."),
    ] = None,
    relative_error: Annotated[
        float | None,
        typer.Option(
            "--relative-error",
            help="Standard error of its luminance at which a pixel or sensor is done. Without it a pixel of "
            "a scene takes all samples, 0.01 for sensors, 0.02 for --preview.",
        ),
    ] = None,
    bounces: Annotated[int, typer.Option(help="Surfaces that a path visits, at most.")] = 64,
    seed: Annotated[int, typer.Option(help="Seed of the random numbers.")] = 1,
    search: Annotated[
        list[Path] | None,
        typer.Option(
            "-I", "--search", help="Folder for files that the scene names; repeat it. Without it RAYPATH."
        ),
    ] = None,
    channel: Annotated[
        str | None, typer.Option("--channel", help="Of --preview: channel of a file that is shown, in grey.")
    ] = None,
    colours: Annotated[
        str | None,
        typer.Option(
            "--colours",
            metavar="LOW,HIGH",
            help="Of a .png: ends of the false colours, cd/m2. Without it from the picture, three decades at "
            "most.",
        ),
    ] = None,
    lux: Annotated[
        bool, typer.Option("--lux", help="Of --sensors: print illuminance and its standard error, lx.")
    ] = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on from the samples beside the result, and keep them.")
    ] = False,
    json: Json = False,
) -> None:
    """Render a scene or a ball of a material, or measure irradiance at points of a scene."""
    if sum((view is not None, sensors is not None, preview is not None)) > 1:
        raise typer.BadParameter("allowed one of them", param_hint="--view, --sensors, --preview")
    if (preview is None) != bool(scene):
        raise typer.BadParameter("needed with --view and --sensors, but not --preview", param_hint="SCENE")
    if sensors is None and to is None:
        raise typer.BadParameter("needed for a picture", param_hint="--out")
    if sensors is not None and to is not None and to.suffix in PICTURE_SUFFIXES:
        raise typer.BadParameter(
            f"found the ending {to.suffix!r} of a picture, allowed that of a text", param_hint="--out"
        )
    ends = _ends(colours)
    if ends is not None and (preview is not None or to is None or to.suffix != ".png"):
        raise typer.BadParameter("allowed with --view and an --out of .png", param_hint="--colours")
    if resume and (preview is not None or to is None):
        raise typer.BadParameter("allowed with --view or --sensors, and --out", param_hint="--resume")
    if preview is not None and to is not None:
        with render_bar(hidden=json) as progress:
            picture = gonio.preview(
                preview,
                out=to,
                channel=channel,
                size=_size(size, 360)[0],
                samples=256 if samples is None else samples,
                relative_error=0.02 if relative_error is None else relative_error,
                seed=seed,
                progress=progress,
            )
        _tell_picture(picture, to, json=json, warnings=[])
        return
    read, warnings = gonio.read_scene(*(scene or []), search=search)
    if not json:
        warn(warnings)
    if sensors is None:
        view = view or read.view
        if view is None:
            raise typer.BadParameter("the scene names none: give a file or options", param_hint="--view")
        with render_bar(hidden=json) as progress:
            picture = gonio.render(
                read,
                view=view,
                out=to,
                size=_size(size, 512),
                samples=256 if samples is None else samples,
                relative_error=relative_error,
                seed=seed,
                bounces=bounces,
                resume=resume,
                colours=ends,
                progress=progress,
            )
        _tell_picture(picture, to, json=json, warnings=warnings)
        return
    rows = gonio.read_sensors(sensors)
    with render_bar(hidden=json) as progress:
        found = gonio.render_sensors(
            read,
            rows,
            samples=1 << 16 if samples is None else samples,
            relative_error=0.01 if relative_error is None else relative_error,
            seed=seed,
            bounces=bounces,
            state=to,
            resume=resume,
            progress=progress,
        )
    wanted = 0.01 if relative_error is None else relative_error
    above = found.standard_error > wanted * np.maximum(found.illuminance, 0.01 * found.illuminance.mean())
    if above.any():
        warnings = [
            *warnings,
            f"{above.sum()} of {len(rows)} sensors took all samples and are above the relative error of "
            f"{wanted:g}: raise --samples",
        ]
        if not json:
            warn(warnings[-1:])
    _tell_sensors(found, to, lux=lux, json=json, warnings=warnings)


def _size(text: str | None, default: int) -> tuple[int, int]:
    if text is None:
        return default, default
    parts = text.lower().split("x")
    try:
        sides = [int(part) for part in parts]
    except ValueError:
        sides = []
    if len(sides) not in {1, 2}:
        raise typer.BadParameter(f"found {text!r}, allowed a number or WIDTHxHEIGHT", param_hint="--size")
    return sides[0], sides[-1]


def _ends(text: str | None) -> tuple[float, float] | None:
    if text is None:
        return None
    try:
        low, high = (float(part) for part in text.split(","))
    except ValueError:
        low = high = math.nan
    if not 0.0 < low < high < math.inf:
        raise typer.BadParameter(
            f"found {text!r}, allowed LOW,HIGH with 0 < LOW < HIGH", param_hint="--colours"
        )
    return low, high


def _tell_picture(picture: gonio.Picture, to: Path | None, *, json: bool, warnings: list[str]) -> None:
    mean = float(picture.luminance.mean())
    error = float(picture.standard_error.mean()) / mean if mean > 0.0 else math.inf
    taken = float(picture.samples.mean())
    if json:
        print_json(
            {
                "out": to,
                "mean_luminance": mean,
                "relative_error": error,
                "samples": taken,
                "view": picture.view,
                "warnings": warnings,
            }
        )
        return
    height, width = picture.luminance.shape
    out.print(
        f"{to}: {width} x {height} pixels, {taken:.0f} paths each on average, "
        f"mean luminance {mean:.4g} cd/m2, {_scatter(error)}"
    )


def _tell_sensors(
    found: gonio.SensorReadings, to: Path | None, *, lux: bool, json: bool, warnings: list[str]
) -> None:
    if lux:
        rows = list(zip(found.illuminance, found.standard_error, strict=True))
    else:
        rows = [tuple(row) for row in found.irradiance]
    text = "".join("\t".join(f"{value:.6e}" for value in row) + "\n" for row in rows)
    if to is not None:
        with replacing_file(to) as staged:
            staged.write_text(text)
    if json:
        print_json(
            {
                "irradiance": found.irradiance.tolist(),
                "illuminance": found.illuminance.tolist(),
                "standard_error": found.standard_error.tolist(),
                "samples": found.samples.tolist(),
                "warnings": warnings,
            }
        )
    elif to is None:
        out.print(text, end="")
    else:
        out.print(f"{to}: {len(rows)} sensors, {'lx and standard error' if lux else 'W/m2'}")


@contextmanager
def render_bar(*, hidden: bool = False) -> Iterator[Report]:
    """Progress on stderr with the present error and the remaining time; nothing where it is no terminal."""
    columns = (
        TextColumn("rendering"),
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.fields[error]}"),
        TextColumn("{task.fields[left]}"),
    )
    with Progress(*columns, console=err, transient=True, disable=hidden or not err.is_terminal) as bar:
        task = bar.add_task("", total=1.0, error="", left="")

        def report(now: RenderProgress) -> None:
            error = f"error {100 * now.error:.2g} %" if math.isfinite(now.error) else ""
            left = "" if now.remaining is None else f"{_duration(now.remaining)} left"
            bar.update(task, completed=now.done, error=error, left=left)

        yield report


def _duration(seconds: float) -> str:
    whole = math.ceil(seconds)
    if whole < 60:
        return f"{whole} s"
    hours, minutes = divmod(whole // 60, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {whole % 60} s"


def _scatter(error: float) -> str:
    """The standard error of a pixel in words; too few paths tell none."""
    return (
        f"standard error of a pixel {100 * error:.2g} %"
        if math.isfinite(error)
        else "too few paths for an error"
    )
