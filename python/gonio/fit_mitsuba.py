"""The Mitsuba 3 material that a fitted model is, or comes closest to; docs/fit.md says what is lost."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as ET

from gonio._native import DomainError
from gonio.fit_colour import Palette, Triple
from gonio.fit_known import require_known
from gonio.fit_results import Fit

SCENE_VERSION = "3.0.0"

NEGLIGIBLE = 1e-3
"""Diffuse shares below this are left out where Mitsuba cannot add them."""

WIDEST_BLEND = 0.5
"""Weight of the lobe in a blend, unless the diffuse part needs more."""

DISTRIBUTIONS = ("ggx", "beckmann")


@dataclass(frozen=True)
class MappedMitsuba:
    """A material as `mitsuba.load_dict` takes it, and what it does not hold of the fit."""

    material: dict[str, Any]
    losses: tuple[str, ...]

    def xml(self, *, name: str = "material", comments: Sequence[str] = ()) -> str:
        """The same as a scene file with one `bsdf`; `comments` stand at its head."""
        head = "".join(f"<!-- {line.replace('--', '- -')} -->\n" for line in comments)
        scene = ET.Element("scene", version=SCENE_VERSION)
        _element(scene, self.material, {"id": name})
        ET.indent(scene)
        return head + ET.tostring(scene, encoding="unicode") + "\n"


def mitsuba_material(
    fit: Fit, *, colour: Triple | None = None, illuminant: str = "D65", as_visible: bool = False
) -> MappedMitsuba:
    """Make the Mitsuba 3 material of a fit.

    lambert maps onto `diffuse` exactly; a diffuse part with microfacets onto a `blendbsdf` of `diffuse` and
    `roughconductor`; a rough dielectric interface without diffuse parts onto `roughdielectric`. What differs
    is stated with its size at the incidences of the fit.

    Parameters
    ----------
    fit, colour, illuminant, as_visible
        As `gonio.fit_radiance.radiance_material`.

    Raises
    ------
    DomainError
        Mitsuba has no such material; channels that make no colour; a parameter that the fit leaves open. The
        message says what to do.
    FormatError
        The wavelengths do not span the visible.
    """
    if not has_mitsuba(fit):
        raise DomainError(_refusal(fit))
    require_known(fit, "Mitsuba material")
    palette = Palette(fit.channels, tint=colour, illuminant=illuminant, as_visible=as_visible)
    parts = {str(p["model"]): p for p in fit.parts}
    lobes = _lobes(fit)
    angles = sorted({round(min(r.theta_i, 180.0 - r.theta_i), 3) for r in fit.residuals})
    losses: list[str] = []
    diffuse = palette.rgb(parts["lambert"]["rho"]) if "lambert" in parts else (0.0, 0.0, 0.0)
    if not lobes:
        material = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": _rgb(diffuse)}}
        return MappedMitsuba(material, tuple(palette.warnings))
    lobe = parts[lobes[0]]
    if "dielectric" in lobes[0]:
        behind = (
            palette.rgb(parts["lambert-transmission"]["tau"]) if "lambert-transmission" in parts else (0.0,)
        )
        material = _interface(lobe, fit, max(*diffuse, *behind), losses)
    else:
        surface = _conductor(lobe, fit, palette, angles, losses)
        material = {"type": "twosided", "bsdf": _blend(diffuse, surface)}
    _masking(lobe, angles, losses)
    return MappedMitsuba(material, (*losses, *palette.warnings))


def has_mitsuba(fit: Fit) -> bool:
    """Whether a Mitsuba material has the form of the fitted model."""
    names, lobes = [str(p["model"]) for p in fit.parts], _lobes(fit)
    others = set(names) - set(lobes) - {"lambert", "lambert-transmission"}
    matt = lobes or set(names) == {"lambert"}
    return not others and len(lobes) <= 1 and bool(matt) and len(set(names)) == len(names)


def _lobes(fit: Fit) -> list[str]:
    """Microfacet parts of the fitted model."""
    return [name for p in fit.parts if (name := str(p["model"])).split("-")[0] in DISTRIBUTIONS]


def _refusal(fit: Fit) -> str:
    parts = [str(p["model"]) for p in fit.parts]
    if any(p.startswith("ward") for p in parts):
        reason = "Mitsuba 3 has no Ward lobe"
    else:
        reason = f"Mitsuba 3 has no material with the parts {', '.join(parts)}"
    return (
        f"Mitsuba material: found the model {fit.model}, allowed lambert, ggx, beckmann and their "
        f"-anisotropic, -conductor and -dielectric variants: {reason}; fit one of these"
    )


def _rgb(value: Triple) -> dict[str, Any]:
    return {"type": "rgb", "value": [float(c) for c in value]}


def _uniform(value: float) -> dict[str, Any]:
    return {"type": "uniform", "value": float(value)}


def _value(number_or_channels: Any) -> float:
    """A width, which all channels share."""
    if isinstance(number_or_channels, Mapping):
        return float(next(iter(number_or_channels.values())))
    return float(number_or_channels)


def _widths(lobe: Mapping[str, Any], losses: list[str]) -> dict[str, Any]:
    common = {"distribution": str(lobe["model"]).split("-", maxsplit=1)[0]}
    if "alpha" in lobe:
        return common | {"alpha": _value(lobe["alpha"])}
    losses.append(
        f"the lobe's x axis is the surface's u direction: turn the texture coordinates by phi_x = "
        f"{_value(lobe['phi_x']):.4g} deg"
    )
    return common | {"alpha_u": _value(lobe["alpha_x"]), "alpha_v": _value(lobe["alpha_y"])}


def _conductor(
    lobe: Mapping[str, Any], fit: Fit, palette: Palette, angles: Sequence[float], losses: list[str]
) -> dict[str, Any]:
    """The reflecting lobe; Schlick's reflectance becomes that of a facet without absorption."""
    widths = _widths(lobe, losses)
    if "k" in lobe:
        index = {name: _rgb(palette.rgb(lobe[name])) for name in ("eta", "k")}
        return {"type": "roughconductor", **index, **widths}
    f0 = palette.rgb(lobe["f0"])
    eta = tuple(_eta_of(min(c, 0.999)) for c in f0)
    size, at, f0_there = max(
        (abs(_fresnel(n, t) - _schlick(c, t)), t, c) for c, n in zip(f0, eta, strict=True) for t in angles
    )
    indices = ", ".join(f"{n:.4g}" for n in dict.fromkeys(eta))
    losses.append(
        f"Schlick's reflectance becomes Fresnel's of index {indices}: at the peak of the lobe it differs by "
        f"up to {100 * size / _schlick(f0_there, at):.2g} % (at theta_i = {at:.4g} deg)"
    )
    red, green, blue = eta
    return {"type": "roughconductor", "eta": _rgb((red, green, blue)), "k": _uniform(0.0), **widths}


def _blend(diffuse: Triple, surface: dict[str, Any]) -> dict[str, Any]:
    """`diffuse + surface` as a weighted mean of both, each over its weight."""
    if max(diffuse) == 0.0:
        return surface
    weight = min(WIDEST_BLEND, 1.0 - max(diffuse))
    if weight <= 0.0:
        raise DomainError(
            f"Mitsuba material: diffuse reflectance: found {max(diffuse):.4g}, allowed below 1: check the "
            "beam power"
        )
    red, green, blue = (c / (1.0 - weight) for c in diffuse)
    return {
        "type": "blendbsdf",
        "weight": weight,
        "bsdf_0": {"type": "diffuse", "reflectance": _rgb((red, green, blue))},
        "bsdf_1": {**surface, "specular_reflectance": _uniform(1.0 / weight)},
    }


def _interface(lobe: Mapping[str, Any], fit: Fit, diffuse: float, losses: list[str]) -> dict[str, Any]:
    if diffuse > NEGLIGIBLE:
        raise DomainError(
            f"Mitsuba material: found a rough interface with a diffuse share of {diffuse:.3g}, allowed up to "
            f"{NEGLIGIBLE:g}: Mitsuba 3 transmits nothing diffusely; fix kd and td at 0 "
            "(--fix kd=0 --fix td=0)"
        )
    etas = lobe["eta"].values() if isinstance(lobe["eta"], Mapping) else [lobe["eta"]]
    mean = sum(etas) / len(list(etas))
    if max(etas) - min(etas) > NEGLIGIBLE:
        losses.append(
            f"eta differs between the channels ({min(etas):.4g} to {max(etas):.4g}); it is {mean:.4g}"
        )
    return {"type": "roughdielectric", "int_ior": float(mean), "ext_ior": 1.0, **_widths(lobe, losses)}


def _masking(lobe: Mapping[str, Any], angles: Sequence[float], losses: list[str]) -> None:
    """Mitsuba masks both directions on their own, gonio with their common height."""
    beckmann = str(lobe["model"]).startswith("beckmann")
    width = max(_value(lobe[name]) for name in ("alpha", "alpha_x", "alpha_y") if name in lobe)
    steepest = max(angles, default=0.0)
    hidden = _lambda(width, math.radians(steepest), beckmann=beckmann)
    loss = 1.0 - (1.0 + 2.0 * hidden) / (1.0 + hidden) ** 2
    losses.append(
        f"Mitsuba masks the two directions independently: its lobe is {100 * loss:.2g} % lower at the mirror "
        f"direction of theta_i = {steepest:.4g} deg, less at smaller angles"
    )


def _lambda(alpha: float, theta: float, *, beckmann: bool) -> float:
    """Smith's Lambda [Walter2007; Heitz2014, eq. 68 and 85]."""
    slope = alpha * math.tan(theta)
    if slope <= 0.0:
        return 0.0
    if beckmann:
        a = 1.0 / slope
        return (math.erf(a) - 1.0) / 2.0 + math.exp(-a * a) / (2.0 * a * math.sqrt(math.pi))
    return (math.sqrt(1.0 + slope * slope) - 1.0) / 2.0


def _eta_of(f0: float) -> float:
    root = math.sqrt(max(f0, 0.0))
    return (1.0 + root) / (1.0 - root)


def _schlick(f0: float, theta: float) -> float:
    return f0 + (1.0 - f0) * (1.0 - math.cos(math.radians(theta))) ** 5


def _fresnel(eta: float, theta: float) -> float:
    """Unpolarised reflectance of a facet of index `eta` without absorption [BornWolf1999]."""
    c = math.cos(math.radians(theta))
    t = math.sqrt(1.0 - (1.0 - c * c) / eta**2)
    return (((c - eta * t) / (c + eta * t)) ** 2 + ((eta * c - t) / (eta * c + t)) ** 2) / 2.0


def _element(parent: ET.Element, value: Mapping[str, Any], attributes: Mapping[str, str]) -> None:
    """One object of the scene under `parent`."""
    kind = str(value["type"])
    if kind in ("rgb", "uniform"):
        numbers = value["value"] if kind == "rgb" else [value["value"]]
        tag = "rgb" if kind == "rgb" else "spectrum"
        text = ", ".join(repr(float(n)) for n in numbers)
        ET.SubElement(parent, tag, dict(attributes), value=text)
        return
    element = ET.SubElement(parent, "bsdf", dict(attributes), type=kind)
    for name, item in value.items():
        if name == "type":
            continue
        if isinstance(item, Mapping):
            plugin = item["type"] not in ("rgb", "uniform")
            _element(element, item, {} if plugin else {"name": name})
        elif isinstance(item, str):
            ET.SubElement(element, "string", name=name, value=item)
        else:
            ET.SubElement(element, "float", name=name, value=repr(float(item)))
