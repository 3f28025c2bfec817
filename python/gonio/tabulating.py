"""From a model to a measurement, without an instrument between them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

from gonio import _native
from gonio._native import Bsdf, Rgl
from gonio.colours import SRGB
from gonio.measurement import Measurement
from gonio.model_files import read_bsdf
from gonio.provenance import input_file, provenance
from gonio.readings import PathLike
from gonio.working import interruptible

U_RELATIVE = 0.01
"""Relative standard uncertainty of values that state none, unless told otherwise."""

U_FLOOR = 0.0002
"""The same of a DSF of 0, 1/sr."""


def tabulate(
    model: Bsdf | PathLike,
    *,
    incidences: Sequence[tuple[float, float]] | None = None,
    components: Sequence[str] | None = None,
    channels: Sequence[str] | None = None,
    pitch: float = 3.0,
    peak_pitch: float = 0.1,
    growth: float = 0.08,
    reach: float = 25.0,
    theta_max: float = 88.0,
    u_relative: float = U_RELATIVE,
    u_floor: float = U_FLOOR,
    sample_name: str | None = None,
) -> Measurement:
    """Evaluate a model over hemispheres of directions, dense about the mirror and the unbent direction.

    The result is what `gonio.process` gives for a real sample: one slice an incidence and channel, with solid
    angles and hemispherical integrals. Values are those of the model itself; no noise is added. Directions in
    which the model has no data (`Bsdf.has_data`) are left out, and the integrals count them as extrapolated.
    `gonio.simulate` instead writes the raw readings of an instrument with all that it adds.

    Parameters
    ----------
    model
        Any model, or a file that `gonio.read_bsdf` reads.
    incidences
        (theta_i, phi_i) in degrees. None takes the incidences that a material of the RGL database was
        measured at, and theta_i of 8, 20, 35, 50, 60, 70 and 75 at phi_i 0 for other models.
    components
        Hemispheres, of "reflection" and "transmission" relative to the lit side; None is reflection.
    channels
        Channels of the model; None takes all.
    pitch
        Pitch of the rings over the hemisphere, degrees, 0.3 to 28.
    peak_pitch
        Pitch at the mirror direction, degrees, up to `pitch`.
    growth
        Growth of the half vector's pitch per unit distance from the normal, 0.01 to 1.
    reach
        Tilt of the half vector, degrees, up to which directions are dense; 0 leaves the rings alone.
    theta_max
        Directions nearer to the horizon than this polar angle are left out, degrees below 90.
    u_relative
        Relative standard uncertainty that the values are given, independent from value to value.
    u_floor
        Standard uncertainty of dsf at 0, 1/sr; both are added in squares.
    sample_name
        Name of the sample; None takes what an RGL file says of its material.

    Raises
    ------
    DomainError
        A setting out of its range; an incidence at which the model has no data.
    QuantityError
        A channel that the model does not have.
    FormatError, OSError
        As `gonio.read_bsdf`.
    """
    inputs: list[dict[str, Any]] = []
    if not isinstance(model, Bsdf):
        inputs.append(input_file(model, role="model"))
        path = os.fspath(model)
        model = read_bsdf(path)
    source: Bsdf = model
    if isinstance(source, Rgl):
        if incidences is None:
            incidences = [(t, p) for p in source.phi_i.tolist() for t in source.measured_theta_i.tolist()]
        sample_name = sample_name or source.description or None
    angles = None if incidences is None else [(float(t), float(p)) for t, p in incidences]
    settings: dict[str, Any] = {
        "components": None if components is None else list(components),
        "channels": None if channels is None else list(channels),
        "pitch": pitch,
        "peak_pitch": peak_pitch,
        "growth": growth,
        "reach": reach,
        "theta_max": theta_max,
        "u_relative": u_relative,
        "u_floor": u_floor,
    }
    data = interruptible(
        lambda: _native.tabulate(source, incidences=angles, sample_name=sample_name, **settings)
    )
    found = [[s.theta_i, s.phi_i] for s in data.slices if s.channel == data.slices[0].channel]
    origin = provenance(inputs=inputs, settings={"incidences": found, **settings})
    origin = {**origin, "instrument": "none: values of a model"}
    if isinstance(source, Rgl) and "red" in source.channels:
        origin["primaries"] = SRGB  # of the RGB files of the database
    return Measurement._wrap(data, provenance=origin)
