"""The Radiance material that a fitted model is, or comes closest to."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from gonio._native import DomainError, RadianceMaterial
from gonio.colours import RADIANCE_PRIMARIES
from gonio.fit_colour import Palette, Triple
from gonio.fit_known import NEGLIGIBLE, require_known
from gonio.fit_results import Fit

LOST = 0.01
"""Relative differences from this size on are told."""

Values = Mapping[str, float]


@dataclass(frozen=True)
class MappedRadiance:
    """A Radiance material, what it does not hold of the fit, and what its numbers are."""

    material: RadianceMaterial
    losses: tuple[str, ...]
    notes: tuple[str, ...] = ()


def radiance_material(
    fit: Fit,
    *,
    name: str = "material",
    colour: Triple | None = None,
    illuminant: str = "D65",
    as_visible: bool = False,
) -> MappedRadiance:
    """Make the Radiance material of a fit.

    plastic, metal, trans, plastic2, metal2 and trans2 are materials themselves; lambert, ward-gmd,
    lambert-transmission and transmission-lobe map onto them, exactly for one channel. Every other model has
    another lobe than Radiance's materials.

    Parameters
    ----------
    fit
        Channels photopic, red/green/blue, or wavelengths across the visible; one channel of any name with
        `colour` or `as_visible`. Red, green and blue are in Radiance's primaries, or linear sRGB where the
        provenance of the fit says so (materials of the RGL database); then they are converted.
    name
        Name of the material.
    colour
        Red, green, blue in Radiance's primaries at any scale, for a fit of one channel; photopic is grey
        without it. The lobe of plastic and trans stays uncoloured.
    illuminant
        D65, A or E: the light under which wavelengths become a colour.
    as_visible
        Take the one channel of the fit, such as 650nm, for the visible: grey.

    Raises
    ------
    DomainError
        No such material; a colour or share above 1; channels that make no colour; a parameter of the material
        that the fit leaves open.
    FormatError
        The wavelengths do not span the visible.
    """
    make = _MAKERS.get(fit.model)
    if make is None:
        raise DomainError(
            f"Radiance material: found the model {fit.model}, allowed {', '.join(_MAKERS)}: Radiance's "
            "materials have no such lobe; fit one of these, or write the data-driven model with gonio export"
        )
    require_known(fit, "Radiance material", without=idle(fit))
    palette = Palette(
        fit.channels,
        tint=colour,
        illuminant=illuminant,
        as_visible=as_visible,
        primaries=fit.provenance.get("primaries", RADIANCE_PRIMARIES),
    )
    losses: list[str] = []
    kind, rgb, numbers, strings = make(_Source(fit, palette, losses))
    for label, value in zip(("red", "green", "blue"), rgb, strict=True):
        if value > 1.0:
            raise DomainError(
                f"Radiance material: {label}: found {value:.4g}, allowed 0 to 1: the sample scatters more "
                "than it gets in this channel; check beam power and colour"
            )
    red, green, blue = rgb
    parameters = {"red": red, "green": green, "blue": blue} | numbers
    material = RadianceMaterial(kind, id=name, strings=strings, modifier="void", **parameters)
    notes = () if palette.note is None else (palette.note,)
    return MappedRadiance(material, (*losses, *palette.warnings), notes)


def has_radiance(fit: Fit) -> bool:
    """Whether a Radiance material has the form of the fitted model."""
    return fit.model in _MAKERS


_SHAPES = ("alpha", "alpha_x", "alpha_y", "phi_x")


def idle(fit: Fit) -> set[str]:
    """Parameters that change nothing because another one leaves no light for them."""
    value = {e.name: e.value for e in fit.estimates if e.channel in (None, fit.channels[0])}
    largest = {e.name: max(o.value for o in fit.estimates if o.name == e.name) for e in fit.estimates}
    idle: set[str] = set()
    if "specularity" in value:
        spec, trans, tspec = (value.get(n, 0.0) for n in ("specularity", "trans", "tspec"))
        if (1.0 - spec) * trans < NEGLIGIBLE:
            idle.add("tspec")
        if fit.model.startswith("plastic") and 1.0 - spec < NEGLIGIBLE:
            idle.add("color")
        if fit.model.startswith("trans") and 1.0 - spec < NEGLIGIBLE:
            idle |= {"color", "trans"}
        lobe = max(spec, (1.0 - spec) * trans * tspec)
    else:
        lobe = max(largest.get("ks", 0.0), largest.get("ts", 0.0))
    return idle | set(_SHAPES) if lobe < NEGLIGIBLE else idle


@dataclass
class _Source:
    """The values of a fit, and where losses are told."""

    fit: Fit
    palette: Palette
    losses: list[str]

    def of(self, name: str) -> Values:
        """Value of a parameter in each channel."""
        return {c: values[name] for c, values in self.fit.parameters.items()}

    def one(self, name: str) -> float:
        """Value of a parameter that all channels share."""
        return self.fit.estimate(name).value

    def shared(self, what: str, values: Values) -> float:
        """One number in place of one a channel."""
        value, spread = self.palette.grey(values)
        if spread > LOST:
            self.losses.append(
                f"{what} differs between the channels by up to {100 * spread:.2g} % of its mean; the "
                "material has the mean in all of them"
            )
        return value


_Made = tuple[str, Triple, dict[str, float], list[str] | None]


def _orientation(s: _Source) -> list[str]:
    """The string arguments that turn u to the azimuth phi_x."""
    phi = math.radians(s.one("phi_x"))
    return [f"{math.cos(phi):.9g}", f"{math.sin(phi):.9g}", "0", "."]


def _widths(s: _Source, *, two: bool) -> dict[str, float]:
    return {"urough": s.one("alpha_x"), "vrough": s.one("alpha_y")} if two else {"rough": s.one("alpha")}


def _named(kind: str) -> Callable[[_Source], _Made]:
    """A fit model that is the Radiance material of that name."""
    two = kind.endswith("2")

    def make(s: _Source) -> _Made:
        numbers = {"spec": s.one("specularity"), **_widths(s, two=two)}
        if kind.startswith("trans"):
            numbers |= {"trans": s.one("trans"), "tspec": s.one("tspec")}
        return kind, s.palette.rgb(s.of("color")), numbers, _orientation(s) if two else None

    return make


def _lobe(*, two: bool) -> Callable[[_Source], _Made]:
    """Diffuse part and lobe with an amplitude each: plastic where the lobe is uncoloured, else metal."""
    suffix = "2" if two else ""

    def make(s: _Source) -> _Made:
        kd, ks = s.of("kd"), s.of("ks")
        strings = _orientation(s) if two else None
        whole = {c: kd[c] + ks[c] for c in kd}
        share = {c: ks[c] / whole[c] if whole[c] > 0.0 else 0.0 for c in kd}
        if s.palette.grey(share)[1] < s.palette.grey(ks)[1]:
            spec = s.shared("share of the lobe", share)
            return f"metal{suffix}", s.palette.rgb(whole), {"spec": spec, **_widths(s, two=two)}, strings
        spec = s.shared("ks", ks)
        if spec >= 1.0:
            return f"metal{suffix}", s.palette.rgb(whole), {"spec": 1.0, **_widths(s, two=two)}, strings
        rgb = s.palette.rgb({c: v / (1.0 - spec) for c, v in kd.items()})
        return f"plastic{suffix}", rgb, {"spec": spec, **_widths(s, two=two)}, strings

    return make


def _matt(s: _Source) -> _Made:
    return "plastic", s.palette.rgb(s.of("kd")), {"spec": 0.0, "rough": 0.0}, None


def _matt_through(s: _Source) -> _Made:
    return (
        "trans",
        s.palette.rgb(s.of("td")),
        {"spec": 0.0, "rough": 0.0, "trans": 1.0, "tspec": 0.0},
        None,
    )


def _through(s: _Source) -> _Made:
    td, ts = s.of("td"), s.of("ts")
    whole = {c: td[c] + ts[c] for c in td}
    share = {c: ts[c] / whole[c] if whole[c] > 0.0 else 0.0 for c in td}
    numbers = {
        "spec": 0.0,
        "rough": s.one("alpha"),
        "trans": 1.0,
        "tspec": s.shared("share of the lobe", share),
    }
    return "trans", s.palette.rgb(whole), numbers, None


_MAKERS: Mapping[str, Callable[[_Source], _Made]] = {
    "plastic": _named("plastic"),
    "metal": _named("metal"),
    "trans": _named("trans"),
    "plastic2": _named("plastic2"),
    "metal2": _named("metal2"),
    "trans2": _named("trans2"),
    "lambert": _matt,
    "ward-gmd": _lobe(two=False),
    "ward-gmd-anisotropic": _lobe(two=True),
    "lambert-transmission": _matt_through,
    "transmission-lobe": _through,
}
