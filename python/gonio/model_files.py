"""Files of models, read or summed up: those of Radiance (XML, .sir, materials), RGL, MERL, compact models."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from gonio import _native
from gonio._native import Bsdf, Compact, FormatError, QuantityError, Rgl
from gonio.compact_files import COMPACT_FORMAT, MAGIC, compact_header, read_compact
from gonio.readings import PathLike
from gonio.working import interruptible

XML_FORMAT = "radiance-xml"
RGL_FORMAT = "rgl-bsdf"
MERL_FORMAT = "merl"
SIR_FORMAT = "radiance-sir"
ZEMAX_FORMAT = "zemax-bsdf"
MATERIAL_SUFFIXES = (".rad", ".mat")
"""Names of Radiance scenes end in these; their text has no mark of its own at the beginning."""

_THETA = np.arange(0.0, 86.0, 5.0)
_PHI = np.arange(0.0, 360.0, 15.0)
"""Incidences in degrees at which the albedo of a tensor tree is looked up."""


@dataclass(frozen=True)
class ComponentSummary:
    """One channel and component of a model.

    `representation` is klems, tensor-tree, interpolant, rgl, merl or compact; `resolution` the angle basis of
    the patches (incident, exit), the rank and the number of cells of all components, incidences, lobes and
    transports of an interpolant, the incidences and the nodes of a table, the cells in theta_h, theta_d and
    phi_d, or symmetry and nodes of a compact table. The directional albedo is the least and the largest
    over all incident patches, for a tensor tree over incidences of 0 to 85 degrees from the normal of the lit
    side, for an RGL material and an interpolant over those measured, for a MERL binary and a compact model
    over 0 to 75 degrees.
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
    """What a file of a model holds; empty text is not stated. `notes` are sentences on where its data end."""

    name: str
    manufacturer: str
    components: list[ComponentSummary]
    notes: list[str] = field(default_factory=list)


def model_format(path: Path) -> str | None:
    """Format of a model's file by its first bytes; None where they are not those of a model.

    Raises
    ------
    OSError
        The operating system refuses.
    """
    if _native.is_tensor_file(path):
        return RGL_FORMAT
    if _native.is_merl(path):
        return MERL_FORMAT
    if _native.is_sir(path):
        return SIR_FORMAT
    with path.open("rb") as file:
        start = file.read(512)
    if start.startswith(MAGIC):
        return COMPACT_FORMAT
    xml = (b"<?xml", b"<WindowElement", b"<!--")
    return XML_FORMAT if start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(xml) else None


def is_model(path: Path) -> bool:
    """Whether a file holds a model by its content, or is named as a Radiance material.

    Raises
    ------
    OSError
        The operating system refuses.
    """
    return model_format(path) is not None or path.suffix.lower() in MATERIAL_SUFFIXES


def is_zemax(path: Path) -> bool:
    """Whether a file is a Zemax tabular BSDF by its content: readings, not a model."""
    try:
        return _native.detect_format(path) == ZEMAX_FORMAT
    except FormatError:
        return False


def _require_model(path: Path) -> None:
    """Refuse a file of readings in place of a model."""
    if model_format(path) is None and is_zemax(path):
        raise FormatError(
            f"{path}: found readings (Zemax tabular BSDF), needed a model: read them with gonio.read or "
            "gonio process, which make a measurement; gonio fit and gonio build make a model of it"
        )


def read_bsdf(path: PathLike, *, channel: str | None = None) -> Bsdf:
    """Read a model from a file: one of Radiance (XML, .sir, material), RGL, MERL, or gonio's compact model.

    Parameters
    ----------
    path
        The file; its content tells the format. An RGL material (tensor file, .bsdf) becomes an `Rgl` model
        with the channels red, green and blue, or one a wavelength; a MERL binary has red, green and blue. A
        compact model (netCDF 3, .nc) has those it was made with. An interpolant of Radiance (.sir) is
        photopic, one side of incidence and component. Text named .rad or .mat holds one Radiance
        material, which is red, green and blue.
    channel
        Of an XML, which holds one model a channel, the channel to read: photopic is the file's Visible, solar
        its Solar, 550nm a wavelength; None is the only one, or photopic where there are several. The others
        keep all their channels; one that they do not have is refused.

    Raises
    ------
    FormatError
        The file does not follow its format, or an XML has no such channel.
    QuantityError
        A material has no such channel.
    OSError
        The operating system refuses.
    """
    file = Path(path)
    found = model_format(file)
    if found == RGL_FORMAT:
        return _rgl_with(file, channel)
    if found == MERL_FORMAT:
        return _merl_with(file, channel)[0]
    if found == SIR_FORMAT:
        return _sir_with(file, channel)[0]
    if found == COMPACT_FORMAT:
        return _compact_with(file, channel)
    if file.suffix.lower() in MATERIAL_SUFFIXES and found is None:
        return _material_with(file, channel)
    _require_model(file)
    return interruptible(lambda: _native.read_radiance_xml(file, channel=channel or _xml_channel(file)))


def _xml_channel(path: Path) -> str:
    """The only channel of an XML, photopic where there are several."""
    there = _native.radiance_xml_channels(path)
    return there[0] if len(there) == 1 else "photopic"


def _check_channel(model: Bsdf, channel: str | None) -> None:
    if channel is not None and channel not in model.channels:
        raise QuantityError(f"channel: found {channel}, needed one of {', '.join(model.channels)}")


def _material_with(path: Path, channel: str | None) -> Bsdf:
    materials = interruptible(lambda: _native.read_radiance_materials(path))
    if len(materials) != 1:
        names = ", ".join(m.id for m in materials) or "none"
        raise FormatError(
            f"{path}: found {len(materials)} materials ({names}), needed one: gonio.materials.radiance makes "
            "models of the others"
        )
    model = materials[0].bsdf()
    _check_channel(model, channel)
    return model


def _rgl_with(path: Path, channel: str | None) -> Rgl:
    model = interruptible(lambda: _native.read_rgl(path))
    _check_channel(model, channel)
    return model


def _compact_with(path: Path, channel: str | None) -> Compact:
    model = read_compact(path)
    _check_channel(model, channel)
    return model


def _merl_with(path: Path, channel: str | None) -> tuple[Bsdf, float]:
    model, empty = interruptible(lambda: _native.read_merl(path))
    _check_channel(model, channel)
    return model, empty


def _sir_with(path: Path, channel: str | None) -> tuple[Bsdf, dict[str, Any]]:
    model, about = interruptible(lambda: _native.read_sir(path))
    _check_channel(model, channel)
    return model, about


def summarise(path: Path, *, channel: str | None = None) -> ModelSummary:
    """Summary of every channel of a file that `read_bsdf` reads, or of one.

    Raises
    ------
    FormatError, QuantityError, OSError
        As `read_bsdf`.
    """
    found = model_format(path)
    if found == MERL_FORMAT:
        return _merl(path, channel)
    if found == SIR_FORMAT:
        return _sir(path, channel)
    if found == RGL_FORMAT:
        return _rgl(_rgl_with(path, channel), [channel] if channel else None)
    if found == COMPACT_FORMAT:
        return _compact(path, channel)
    _require_model(path)
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


def _rgl(model: Rgl, asked: list[str] | None) -> ModelSummary:
    channels = asked or model.channels
    theta_i, phi_i = model.measured_theta_i, model.phi_i
    incidences = [(t, p) for p in phi_i.tolist() for t in theta_i.tolist()]
    slices = _native.tabulate(model, incidences=incidences, channels=channels).slices
    height, width = model.resolution
    components = []
    for channel in channels:
        dhr = [s.integrals[0].value for s in slices if s.channel == channel and s.integrals]
        components.append(
            ComponentSummary(
                channel=channel,
                side="front",
                component="reflection",
                representation="rgl",
                resolution=f"{len(model.theta_i)} x {len(phi_i)} incidences, {height} x {width}",
                albedo_min=min(dhr, default=float("nan")),
                albedo_max=max(dhr, default=float("nan")),
            )
        )
    notes = []
    if len(theta_i) < len(model.theta_i):
        notes.append(f"measured up to theta_i {theta_i[-1]:.2f}; beyond it the last incidence is repeated")
    share = model.negative_share
    negative = [f"{100 * share[c]:.2g} % of {c}" for c in channels if share[c] > 0]
    if negative:
        notes.append(f"negative values in {', '.join(negative)} are raised to 0")
    return ModelSummary(name=model.description, manufacturer="", components=components, notes=notes)


def _sir(path: Path, channel: str | None) -> ModelSummary:
    model, about = _sir_with(path, channel)
    thetas = [min(t, 180.0 - t) for t, _ in about["incidences"]]
    isotropic = model.properties["isotropic"]
    kind = "isotropic" if isotropic else "anisotropic"
    size = f"{about['lobes']} lobes, {about['transports']} transports"
    component = ComponentSummary(
        channel=model.channels[0],
        side=about["side"],
        component=about["component"],
        representation="interpolant",
        resolution=f"{kind}, {len(thetas)} incidences, {size}",
        albedo_min=about["albedo_min"],
        albedo_max=about["albedo_max"],
    )
    notes = [
        f"incidences of {min(thetas):.1f} to {max(thetas):.1f} deg from the normal; outside of them "
        f"{about['floor']:.3g} /sr answers, with one lobe where the file has one"
    ]
    return ModelSummary(
        name=about["name"], manufacturer=about["manufacturer"], components=[component], notes=notes
    )


def _merl(path: Path, channel: str | None) -> ModelSummary:
    model, empty = _merl_with(path, channel)
    theta_i = np.arange(0.0, 76.0, 15.0).tolist()
    components = []
    for name in [channel] if channel else model.channels:
        albedo = [
            _native.directional_albedo(model, theta_i=t, phi_i=0.0, component="reflection", channel=name)
            for t in theta_i
        ]
        components.append(
            ComponentSummary(
                channel=name,
                side="front",
                component="reflection",
                representation="merl",
                resolution="90 x 90 x 180 cells",
                albedo_min=min(albedo),
                albedo_max=max(albedo),
            )
        )
    notes = [f"{100 * empty:.2g} % of the cells hold no value"] if empty else []
    return ModelSummary(name="", manufacturer="", components=components, notes=notes)


def _compact(path: Path, channel: str | None) -> ModelSummary:
    model = _compact_with(path, channel)
    header = compact_header(path)
    isotropic = model.properties["isotropic"]
    components = []
    for part in model.parts():
        side, component = part["side"], part["component"]
        shape = " x ".join(str(n) for n in part["codes"].shape[1:] if n > 1)
        lobes = ", ".join(lobe["model"] for lobe in part["base"])
        for name in [channel] if channel else model.channels:
            albedo = [
                _native.compare_models(
                    model,
                    model,
                    theta_i=t if side == "front" else 180.0 - t,
                    phi_i=p,
                    component=component,
                    channel_a=name,
                    channel_b=name,
                )["albedo_a"]
                for t in np.arange(0.0, 76.0, 15.0).tolist()
                for p in ([0.0] if isotropic else [0.0, 45.0, 90.0, 135.0])
            ]
            components.append(
                ComponentSummary(
                    channel=name,
                    side=side,
                    component=component,
                    representation="compact",
                    resolution=f"{part['symmetry']}, {shape} on {lobes}",
                    albedo_min=min(albedo),
                    albedo_max=max(albedo),
                )
            )
    notes = [
        f"{side} {component}: {100 * max(errors):.2g} % relative L1 from the model it was made of"
        for (side, component), errors in header["error"].items()
    ]
    for part in model.ideal_parts():
        least, most = 100 * float(part["shares"].min()), 100 * float(part["shares"].max())
        notes.append(
            f"{part['side']} {part['component']}: {least:.2f} to {most:.2f} % of the light unscattered"
        )
    return ModelSummary(name=header["name"], manufacturer="", components=components, notes=notes)


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
