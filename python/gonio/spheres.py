"""Integrating spheres described in TOML files (docs/formats/sphere-toml.md)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

from gonio import _native
from gonio._native import DomainError, FormatError, IntegratingSphere
from gonio.instrument_keys import Key, Number, Pair, Section, Word, parse_toml, read_section
from gonio.readings import PathLike

FORMAT = "gonio-sphere 1"

ARRANGEMENTS = ("reflection", "transmission")
"""Whether light that the sample reflects into the sphere is measured, or light it lets through."""

METHODS = ("substitution", "auxiliary", "comparison")
"""How the change of the sphere by the sample is dealt with."""

PORTS = ("sample", "entrance", "trap", "detector", "comparison", "auxiliary")
"""Ports by name; figure 6.6 of the source chapter numbers them 1, 3, 5, 2."""

PLACE = {
    "theta": Number(0.0, 180.0),
    "phi": Number(-360.0, 360.0),
    "diameter_mm": Number(0.1, 1e4),
}

SECTIONS: Mapping[str, Mapping[str, Key]] = {
    "": {
        "format": Word((FORMAT,)),
        "name": Word(),
        "arrangement": Word(ARRANGEMENTS),
        "method": Word(METHODS),
        "theta_i": Number(0.0, 85.0),
        "sphere": Section(),
        "beam": Section(),
        "sample": Section(),
        "entrance": Section(required=False),
        "trap": Section(required=False),
        "detector": Section(),
        "standard": Section(required=False),
        "comparison": Section(required=False),
        "auxiliary": Section(required=False),
        "baffle": Section(many=True, required=False),
    },
    "sphere": {"diameter_mm": Number(20.0, 2e4), "wall": Number(0.05, 0.999)},
    "beam": {"diameter_mm": Number(1e-3, 1e4), "divergence": Number(0.0, 11.0, 0.0)},
    "sample": {"diameter_mm": Number(0.1, 1e4)},
    "entrance": {"diameter_mm": Number(0.1, 1e4)},
    "trap": {
        "diameter_mm": Number(0.1, 1e4),
        "plug": Number(0.0, 1.0, required=False),
        "residual": Number(0.0, 1.0, 0.0),
    },
    "detector": {**PLACE, "reflectance": Number(0.0, 1.0, 0.0), "view": Number(0.6, 90.0, 90.0)},
    "standard": {"reflectance": Number(0.01, 1.0), "u": Number(0.0, 0.5, 0.0)},
    "comparison": PLACE,
    "auxiliary": PLACE,
    "baffle": {
        "between": Pair(PORTS),
        "at": Number(0.02, 0.98),
        "diameter_mm": Number(0.1, 1e4),
        "reflectance": Number(0.0, 1.0, required=False),
    },
}
"""Keys of every section with what they allow."""


@dataclass(frozen=True)
class Sphere:
    """An integrating sphere as its file describes it.

    Attributes
    ----------
    name
        Its name.
    arrangement
        One of `ARRANGEMENTS`.
    method
        One of `METHODS`.
    theta_i
        Angle of incidence, degrees.
    standard, u_standard
        Reflectance of the reference standard and its relative standard uncertainty; 1 and 0 in transmission.
    settings
        Numbers of the core: lengths in metres, angles in degrees.
    baffles
        Ports between which each stands, how far on the way, radius in metres, reflectance.
    source
        The file.
    """

    name: str
    arrangement: str
    method: str
    theta_i: float
    standard: float
    u_standard: float
    settings: Mapping[str, float]
    baffles: tuple[tuple[str, str, float, float, float], ...] = ()
    source: str = ""

    def native(self, *, theta_i: float | None = None, phi_i: float = 0.0) -> IntegratingSphere:
        """The sphere as the core has it, at another incidence if one is given.

        Raises
        ------
        DomainError
            Ports that overlap, a beam that does not fit through a port, a baffle in the way, a lamp that
            shines on no bare wall.
        """
        turned = {"theta_i": self.theta_i if theta_i is None else theta_i, "phi_i": phi_i}
        return _native.IntegratingSphere(
            arrangement=self.arrangement,
            settings={**self.settings, **turned},
            baffles=list(self.baffles),
        )


def spheres() -> dict[str, str]:
    """Return names of the spheres that come with gonio, each with the first lines of its file."""
    found = {}
    for entry in sorted(files("gonio").joinpath("presets", "spheres").iterdir(), key=lambda e: e.name):
        if entry.name.endswith(".toml"):
            text = entry.read_text(encoding="utf-8")
            comment = [line[1:].strip() for line in text.partition("format")[0].splitlines()]
            found[entry.name.removesuffix(".toml")] = " ".join(comment)
    return found


def read_sphere(path: PathLike) -> Sphere:
    """Read the file of a sphere, or the preset of that name where there is no such file.

    Raises
    ------
    FormatError
        Not TOML, an unknown or missing key, a value out of its range, a geometry that cannot be built: the
        message names the file and the key.
    DomainError
        Neither a file nor a preset.
    OSError
        The file cannot be read.
    """
    target = Path(path)
    if not target.exists() and str(path) in spheres():
        text = files("gonio").joinpath("presets", "spheres", f"{path}.toml").read_text(encoding="utf-8")
        return parse_sphere(text, source=f"{path}.toml")
    if not target.exists() and target.suffix != ".toml":
        raise DomainError(f"sphere: found {str(path)!r}, allowed a file, or one of {', '.join(spheres())}")
    return parse_sphere(target.read_bytes().decode("utf-8", errors="replace"), source=str(target))


def parse_sphere(text: str, *, source: str) -> Sphere:
    """Parse the text of a sphere's file; `source` names it in errors.

    Raises
    ------
    FormatError
        As `read_sphere`.
    """
    raw = parse_toml(text, source=source, kind=FORMAT)
    found = _Reader(source).sphere(raw)
    try:
        found.native()
    except DomainError as error:
        raise FormatError(f"{source}: {error}") from None
    return found


@dataclass(frozen=True)
class _Reader:
    source: str

    def refuse(self, key: str, found: str, allowed: str) -> FormatError:
        return FormatError(f"{self.source}: {key}: found {found}, allowed {allowed}")

    def section(self, name: str, raw: Any) -> dict[str, Any]:
        """The values of a section, defaults filled in."""
        return read_section(SECTIONS[name], raw, name=name, refuse=self.refuse)

    def sphere(self, raw: Mapping[str, Any]) -> Sphere:
        top = self.section("", raw)
        reflection = top["arrangement"] == "reflection"
        for key in ("entrance", "standard"):
            if reflection and top[key] is None:
                raise self.refuse(key, "nothing", "a section: reflection needs it")
        if not reflection:
            for key in ("entrance", "standard"):
                if top[key] is not None:
                    raise self.refuse(
                        key, "a section", "none in transmission: the sample covers the entrance"
                    )
        method = top["method"]
        if method == "comparison" and not reflection:
            raise self.refuse("method", "comparison in transmission", "substitution, auxiliary")
        if method in ("comparison", "auxiliary") and top[method] is None:
            raise self.refuse(method, "nothing", f"a section: the method {method} needs it")
        body, beam = self.section("sphere", top["sphere"]), self.section("beam", top["beam"])
        wall = float(body["wall"])
        detector = self.section("detector", top["detector"])
        settings = {
            "radius": 0.5e-3 * body["diameter_mm"],
            "wall": wall,
            "plug": wall,
            "standard": 1.0,
            "beam_radius": 0.5e-3 * beam["diameter_mm"],
            "divergence": beam["divergence"],
            "sample_radius": self.radius("sample", top),
            "entrance_radius": self.radius("entrance", top) if reflection else 0.0,
            "detector_reflectance": detector["reflectance"],
            "detector_view": detector["view"],
        }
        u_standard = 0.0
        if reflection:
            standard = self.section("standard", top["standard"])
            settings["standard"], u_standard = standard["reflectance"], float(standard["u"])
        if top["trap"] is not None:
            trap = self.section("trap", top["trap"])
            settings["trap_radius"] = 0.5e-3 * trap["diameter_mm"]
            settings["trap_residual"] = trap["residual"]
            settings["plug"] = wall if trap["plug"] is None else trap["plug"]
        for name in ("detector", "comparison", "auxiliary"):
            if top[name] is not None:
                place = self.section(name, top[name])
                settings[f"{name}_theta"], settings[f"{name}_phi"] = place["theta"], place["phi"]
                settings[f"{name}_radius"] = 0.5e-3 * place["diameter_mm"]
        return Sphere(
            name=top["name"],
            arrangement=top["arrangement"],
            method=method,
            theta_i=float(top["theta_i"]),
            standard=float(settings["standard"]),
            u_standard=u_standard,
            settings={key: float(value) for key, value in settings.items()},
            baffles=tuple(self.baffle(row, wall) for row in top["baffle"] or []),
            source=self.source,
        )

    def radius(self, name: str, top: Mapping[str, Any]) -> float:
        return 0.5e-3 * float(self.section(name, top[name])["diameter_mm"])

    def baffle(self, row: Any, wall: float) -> tuple[str, str, float, float, float]:
        values = self.section("baffle", row)
        reflectance = wall if values["reflectance"] is None else values["reflectance"]
        first, second = values["between"]
        return first, second, float(values["at"]), 0.5e-3 * values["diameter_mm"], float(reflectance)
