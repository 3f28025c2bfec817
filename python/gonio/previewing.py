"""A look at a material: a ball of it on a plane, under a studio light."""

from __future__ import annotations

import os
from pathlib import Path

from gonio import _native
from gonio._native import Bsdf, DomainError, Scene
from gonio.files import check_file
from gonio.materials import MATERIALS, material
from gonio.picture_files import PICTURE_SUFFIXES, Picture, tone_mapped
from gonio.readings import PathLike
from gonio.rendering import render
from gonio.rendering_runs import Report, unwatched
from gonio.shown_models import shown_model


def studio_scene(model: Bsdf) -> tuple[Scene, str]:
    """Return the scene of a preview and the view of it.

    A ball of radius 1 of the material stands on a chequered grey plane (reflectances 0.45 and 0.25), lit by a
    square lamp of 4 m² and a soft sky. The y axis of a material with axes points up.

    Parameters
    ----------
    model
        A model of one channel, which is grey, or of red, green and blue.

    Raises
    ------
    QuantityError
        Other channels.
    """
    return _native.studio_scene(model)


def preview(
    model: Bsdf | PathLike,
    *,
    out: PathLike | None = None,
    channel: str | None = None,
    size: int = 360,
    samples: int = 256,
    relative_error: float | None = 0.02,
    seed: int = 1,
    progress: Report = unwatched,
) -> Picture:
    """Render a ball of a material, on a plane under a studio light.

    Parameters
    ----------
    model
        A model, the name of a known material (`gonio.materials.MATERIALS`), a file that `read_bsdf` reads, a
        fit (its directory or fit.json), or the directory of a measurement, of which a data-driven model is
        built.
    out
        The file: .png is tone-mapped for the eye (Reinhard's curve, exposure from the picture), .exr and .hdr
        hold radiances. Without it nothing is written.
    channel
        Of a file, the channel that is shown, in grey.
    size
        Width and height in pixels.
    samples, relative_error, seed, progress
        As `render`.

    Raises
    ------
    DomainError, QuantityError
        Another ending, a model of other channels than one or red, green and blue.
    FormatError, OSError
        The file cannot be read or written.
    """
    target = None if out is None else check_file(out)
    if target is not None and target.suffix not in PICTURE_SUFFIXES:
        raise DomainError(f"out: found the ending {target.suffix!r}, allowed {', '.join(PICTURE_SUFFIXES)}")
    scene, view = studio_scene(_model(model, channel))
    shown = target is not None and target.suffix == ".png"
    picture = render(
        scene,
        view=view,
        out=None if shown else target,
        size=size,
        samples=samples,
        relative_error=relative_error,
        seed=seed,
        progress=progress,
    )
    if target is not None and shown:
        tone_mapped(picture, out=target)
    return picture


def _model(model: Bsdf | PathLike, channel: str | None) -> Bsdf:
    if isinstance(model, Bsdf):
        return model
    name = os.fspath(model)
    if not Path(name).exists():
        if name in MATERIALS:
            return material(name).bsdf
        raise DomainError(
            f"model: found {name!r}, which is no file; allowed a file or directory of a model, or "
            f"{', '.join(MATERIALS)}"
        )
    return shown_model(name, channel=channel)
