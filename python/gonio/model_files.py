"""What is in a Radiance BSDF XML file: channels, components, representation, albedo."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gonio import _native

FORMAT = "radiance-xml"

_THETA = np.arange(0.0, 86.0, 5.0)
_PHI = np.arange(0.0, 360.0, 15.0)
"""Incidences in degrees at which the albedo of a tensor tree is looked up."""


@dataclass(frozen=True)
class ComponentSummary:
    """One channel and component of a model.

    `representation` is klems or tensor-tree; `resolution` the angle basis of the patches (incident, exit), or
    the rank and the number of cells of all components. The directional albedo is the least and the largest
    over all incident patches, for a tensor tree over incidences of 0 to 85 degrees from the normal of the lit
    side.
    """

    channel: str
    side: str
    component: str
    representation: str
    resolution: str
    albedo_min: float
    albedo_max: float


@dataclass(frozen=True)
class ModelSummary:
    """What a file of a model holds; empty text is not stated."""

    name: str
    manufacturer: str
    components: list[ComponentSummary]


def is_radiance_xml(path: Path) -> bool:
    """Tell by its first bytes whether a file is XML.

    Raises
    ------
    OSError
        The operating system refuses.
    """
    with path.open("rb") as file:
        start = file.read(512)
    return start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith((b"<?xml", b"<WindowElement", b"<!--"))


def summarise(path: Path, *, channel: str | None = None) -> ModelSummary:
    """Summary of every channel of a Radiance or WINDOW BSDF XML file, or of one.

    Raises
    ------
    FormatError
        The file does not follow the format, or has no such channel.
    OSError
        The operating system refuses.
    """
    # A file without any channel is refused by the reader, which says why.
    channels = [channel] if channel else _native.radiance_xml_channels(path) or ["photopic"]
    models = [_native.read_radiance_xml(path, channel=c) for c in channels]
    return ModelSummary(
        name=models[0].material["name"],
        manufacturer=models[0].material["manufacturer"],
        components=[
            _component(model, c, side, component)
            for c, model in zip(channels, models, strict=True)
            for side, component in model.components
        ],
    )


def _component(
    model: _native.Klems | _native.TensorTree, channel: str, side: str, component: str
) -> ComponentSummary:
    if isinstance(model, _native.Klems):
        representation = "klems"
        resolution = ", ".join(dict.fromkeys(model.bases(side=side, component=component)))
        albedo = model.albedo(side=side, component=component)
    else:
        representation, resolution = "tensor-tree", f"rank {model.rank}, {model.cells} cells"
        theta = _THETA if side == "front" else 180.0 - _THETA
        phi = _PHI if model.rank == 4 else _PHI[:1]
        albedo = np.array([model.albedo(theta_i=t, phi_i=p, component=component) for t in theta for p in phi])
    return ComponentSummary(
        channel=channel,
        side=side,
        component=component,
        representation=representation,
        resolution=resolution,
        albedo_min=float(albedo.min()),
        albedo_max=float(albedo.max()),
    )
