"""The model that a file or directory stands for, where a material is to be seen."""

from __future__ import annotations

import os
from pathlib import Path

from gonio._native import Bsdf
from gonio.building import build
from gonio.fit_outputs import JSON_NAME, read_fitted_model
from gonio.measurement import Measurement
from gonio.measurement_header import JSON_NAME as MEASUREMENT_NAME
from gonio.model_files import read_bsdf
from gonio.readings import PathLike


def shown_model(path: PathLike, *, channel: str | None = None) -> Bsdf:
    """Read the model to show: of a file that `read_bsdf` reads, of a fit, or of a measurement.

    Parameters
    ----------
    path
        A file of a model; fit.json or a directory that `gonio fit` wrote; a directory that `gonio process`
        wrote, whose measurement becomes a data-driven model (`build`). A directory with both shows the fit.
    channel
        As `read_bsdf`, and of a measurement with several; a fit is shown with the channels that it has.

    Raises
    ------
    FormatError, QuantityError, DomainError
        As `read_bsdf`, `read_fitted_model` and `build`.
    OSError
        The operating system refuses.
    """
    place = Path(path)
    if place.is_dir():
        if not (place / JSON_NAME).is_file() and (place / MEASUREMENT_NAME).is_file():
            return build(Measurement.load(place), channel=channel)
        return read_fitted_model(place)
    if place.suffix.lower() == ".json":
        return read_fitted_model(place)
    return read_bsdf(place, channel=channel)


def model_of_scene(path: str | os.PathLike[str]) -> Bsdf:
    """Read a model that a scene names."""
    return shown_model(path)
