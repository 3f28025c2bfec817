"""Virtual instruments described in TOML files (docs/formats/instrument-toml.md)."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib.resources import files
from itertools import pairwise
from pathlib import Path
from typing import Any

from gonio._native import DomainError, FormatError
from gonio.instrument_keys import parse_toml, read_section
from gonio.instrument_optics import lens
from gonio.instrument_sections import FORMAT, PATCH, SECTIONS
from gonio.instrument_spectra import Channel, Lamp, channel, lamp
from gonio.instrument_tables import incidence_rows, pair_rows
from gonio.readings import PathLike


@dataclass(frozen=True)
class Instrument:
    """A virtual goniophotometer as its file describes it.

    `settings` are its numbers as `gonio.simulate` takes them (metres, degrees), `parts` what is no single
    number. `theta_i` and `phi_i` are the incidences its holder reaches, degrees. `u_calibration` is the
    relative standard uncertainty its data sheet states for all that dark records and reference scans do not
    tell: hand it to `gonio.process`. `described` holds the keys of the file as they stand there, `directory`
    is where its tables lie.
    """

    name: str
    settings: Mapping[str, float]
    parts: Mapping[str, Any] = field(default_factory=dict)
    lamp: Lamp | None = None
    channels: tuple[Channel, ...] = ()
    theta_i: tuple[float, float] = (0.0, 180.0)
    phi_i: tuple[float, float] = (0.0, 360.0)
    u_calibration: float = 0.0
    source: str = ""
    described: Mapping[str, Any] = field(default_factory=dict, repr=False)
    directory: Path = Path()

    def with_settings(self, settings: Mapping[str, float]) -> Instrument:
        """Return this instrument with numbers of `settings` in place of its own."""
        numbers = dict(self.settings)
        if {"beam_half_width", "beam_radius"} & set(settings):
            numbers.pop("beam_half_width", None)
            numbers.pop("beam_radius", None)
        return replace(self, settings={**numbers, **settings})

    def reaches(self, incidences: Sequence[tuple[float, float]]) -> None:
        """Check that the holder reaches the incidences, degrees.

        Raises
        ------
        DomainError
            One is out of its reach.
        """
        for theta, phi in incidences:
            turned = phi % 360.0
            if not (self.theta_i[0] <= theta <= self.theta_i[1] and self.phi_i[0] <= turned <= self.phi_i[1]):
                raise DomainError(
                    f"incidences: found theta_i = {theta:g}, phi_i = {phi:g} degrees, allowed theta_i "
                    f"{self.theta_i[0]:g} to {self.theta_i[1]:g}, phi_i {self.phi_i[0]:g} to "
                    f"{self.phi_i[1]:g} on the holder of {self.name}"
                )


def presets() -> dict[str, str]:
    """Return names of the instruments that come with gonio, each with the first line of its file."""
    found = {}
    for entry in sorted(files("gonio").joinpath("presets").iterdir(), key=lambda e: e.name):
        if entry.name.endswith(".toml"):
            text = entry.read_text(encoding="utf-8")
            comment = [line[1:].strip() for line in text.partition("format")[0].splitlines()]
            found[entry.name.removesuffix(".toml")] = " ".join(comment)
    return found


def read_instrument(path: PathLike) -> Instrument:
    """Read an instrument file, or the preset of that name where there is no such file.

    Raises
    ------
    FormatError
        Not TOML, an unknown or missing key, a value out of its range, an impossible geometry: the message
        names the file and the key.
    OSError
        The file cannot be read.
    """
    target = Path(path)
    if not target.exists() and str(path) in presets():
        text = files("gonio").joinpath("presets", f"{path}.toml").read_text(encoding="utf-8")
        return parse_instrument(text, source=f"{path}.toml")
    if not target.exists() and target.suffix != ".toml":
        raise DomainError(
            f"instrument: found {str(path)!r}, allowed a file, or one of {', '.join(presets())}"
        )
    return parse_instrument(
        target.read_bytes().decode("utf-8", errors="replace"), source=str(target), directory=target.parent
    )


def parse_instrument(text: str, *, source: str, directory: Path | None = None) -> Instrument:
    """Parse the text of an instrument file; `source` names it in errors, `directory` holds its tables.

    Raises
    ------
    FormatError
        As `read_instrument`.
    """
    raw = parse_toml(text, source=source, kind=FORMAT)
    return _Reader(source, directory or Path()).instrument(raw)


@dataclass(frozen=True)
class _Reader:
    source: str
    directory: Path

    def refuse(self, key: str, found: str, allowed: str) -> FormatError:
        return FormatError(f"{self.source}: {key}: found {found}, allowed {allowed}")

    def section(self, name: str, raw: Any) -> dict[str, Any]:
        """The values of a section, defaults filled in."""
        return read_section(SECTIONS[name], raw, name=name, refuse=self.refuse)

    def rows(self, name: str, raw: Any) -> list[dict[str, Any]]:
        return [self.section(name, row) for row in raw or []]

    def numbers(self, name: str, values: Mapping[str, Any]) -> dict[str, float]:
        """The settings of the core that a section gives."""
        keys = SECTIONS[name]
        return {
            kind.setting: float(values[key]) * kind.factor
            for key, kind in keys.items()
            if kind.setting and values[key] is not None
        }

    def instrument(self, raw: Mapping[str, Any]) -> Instrument:
        top = self.section("", raw)
        lamp_keys, beam, holder, detector, path = (
            self.section(name, top[name]) for name in ("lamp", "beam", "holder", "detector", "path")
        )
        settings: dict[str, float] = {}
        for name, values in (
            ("lamp", lamp_keys),
            ("holder", holder),
            ("detector", detector),
            ("path", path),
        ):
            settings |= self.numbers(name, values)
        settings["aperture"] = self.aperture(detector)
        parts: dict[str, Any] = {"focus": beam["focus"], "patch": None}
        self.add_beam(beam, top["optics"], settings, parts)
        self.add_holder(holder, settings)
        if detector["bits"] != int(detector["bits"]):
            raise self.refuse("detector.bits", str(detector["bits"]), "a whole number")
        ranges = self.rows("detector.range", detector["range"])
        if ranges:
            self.check_ranges(ranges)
            parts["ranges"] = [(r["full_scale"], r["noise_readout"], r["gain_error"]) for r in ranges]
        self.add_path(path, parts)
        light = lamp(lamp_keys, refuse=self.refuse, directory=self.directory)
        channels = tuple(
            channel(row, lamp=light, refuse=self.refuse, directory=self.directory)
            for row in self.rows("detector.channel", detector["channel"])
        )
        names = [c.name for c in channels]
        if len(set(names)) < len(names):
            raise self.refuse("detector.channel.name", ", ".join(names), "each name once")
        return Instrument(
            name=top["name"],
            settings=settings,
            parts=parts,
            lamp=light,
            channels=channels,
            theta_i=self.reach("theta_i", holder, (0.0, 180.0)),
            phi_i=self.reach("phi_i", holder, (0.0, 360.0)),
            u_calibration=float(top["u_calibration"]),
            source=self.source,
            described=raw,
            directory=self.directory,
        )

    def reach(self, key: str, holder: Mapping[str, Any], whole: tuple[float, float]) -> tuple[float, float]:
        if holder[key] is None:
            return whole
        low, high = (float(v) for v in holder[key])
        if low > high:
            raise self.refuse(f"holder.{key}", f"[{low:g}, {high:g}]", "the lower angle first")
        return low, high

    def aperture(self, detector: Mapping[str, Any]) -> float:
        """Half angle of the aperture, degrees."""
        half, diameter = detector["aperture"], detector["aperture_diameter_mm"]
        if (half is None) == (diameter is None):
            found = "neither" if half is None else "both"
            raise self.refuse("detector.aperture", found, "aperture or aperture_diameter_mm")
        if half is not None:
            return float(half)
        return math.degrees(math.atan(0.5 * diameter / detector["distance_mm"]))

    def add_beam(
        self,
        beam: Mapping[str, Any],
        optics: Mapping[str, Any] | None,
        settings: dict[str, float],
        parts: dict[str, Any],
    ) -> None:
        width = {"gaussian": "half_width", "top-hat": "radius", "table": "table"}[beam["profile"]]
        given = [k for k in ("half_width", "radius", "table") if beam[k] is not None]
        if optics is not None:
            if given or beam["spot_diameter_mm"] is not None or beam["profile"] != "top-hat":
                raise self.refuse(
                    "optics", "a beam of its own beside it", "profile = 'top-hat' without widths and spot"
                )
            radius, spot = lens(
                self.section("optics", optics),
                focus=beam["focus"],
                distance_mm=1e3 * settings["distance"],
                refuse=self.refuse,
            )
            settings |= {"beam_radius": radius, "spot_diameter": spot}
            return
        if given != [width]:
            raise self.refuse(
                f"beam.{width}",
                ", ".join(given) or "nothing",
                f"{width} alone with profile {beam['profile']}",
            )
        if beam["spot_diameter_mm"] is None:
            raise self.refuse("beam.spot_diameter_mm", "nothing", "0 to 100")
        settings |= self.numbers("beam", beam)
        if width == "table":
            parts["profile"] = pair_rows(self.directory / beam["table"], key="beam.table", refuse=self.refuse)

    def add_holder(self, holder: Mapping[str, Any], settings: dict[str, float]) -> None:
        if holder["tilt"] is not None:
            settings["tilt_x"], settings["tilt_y"] = (float(t) for t in holder["tilt"])
        round_, width, height = (holder[f"sample_{k}_mm"] for k in ("diameter", "width", "height"))
        if (width is None) != (height is None) or (round_ is not None and width is not None):
            raise self.refuse(
                "holder.sample_width_mm",
                f"diameter {round_}, width {width}, height {height}",
                "sample_diameter_mm, or sample_width_mm and sample_height_mm, or neither",
            )
        smallest = round_ if round_ is not None else (min(width, height) if width is not None else None)
        spot = 1e3 * settings["spot_diameter"]
        if smallest is not None and smallest < spot and not holder["overfill"]:
            raise self.refuse(
                "holder.overfill",
                f"a sample of {smallest:g} mm smaller than the spot of {spot:g} mm",
                "a larger sample or overfill = true",
            )
        if 1e3 * settings["distance"] <= holder["radius_mm"]:
            raise self.refuse(
                "detector.distance_mm",
                f"{1e3 * settings['distance']:g}, inside the sample holder",
                f"more than holder.radius_mm = {holder['radius_mm']:g}",
            )

    def check_ranges(self, ranges: Sequence[Mapping[str, Any]]) -> None:
        scales = [r["full_scale"] for r in ranges]
        if any(a >= b for a, b in pairwise(scales)):
            raise self.refuse("detector.range.full_scale", str(scales), "increasing numbers")

    def add_path(self, path: Mapping[str, Any], parts: dict[str, Any]) -> None:
        if path["planes"] is not None:
            parts["planes"] = [float(p) for p in path["planes"]]
        regions = []
        for row in self.rows("path.region", path["region"]):
            theta, phi = self.centre(row)
            patch = tuple(float(row[k]) for k in PATCH)
            regions.append((row["around"], (theta, phi), patch))
        if regions:
            parts["regions"] = regions
        if path["prescan"] is not None:
            scan = self.section("path.prescan", path["prescan"])
            if scan["count"] != int(scan["count"]):
                raise self.refuse("path.prescan.count", str(scan["count"]), "a whole number")
            patch = tuple(float(scan[f"region_{k}"]) for k in PATCH)
            parts["prescan"] = (float(scan["pitch"]), float(scan["threshold"]), int(scan["count"]), patch)
        if path["table"] is not None:
            parts["table"] = incidence_rows(
                self.directory / path["table"], key="path.table", refuse=self.refuse
            )

    def centre(self, row: Mapping[str, Any]) -> tuple[float, float]:
        direction = row["direction"]
        if (row["around"] == "direction") != (direction is not None):
            raise self.refuse(
                "path.region.direction",
                "nothing" if direction is None else str(direction),
                "[theta_s, phi_s] with around = 'direction' alone",
            )
        if direction is None:
            return 0.0, 0.0
        theta, phi = (float(v) for v in direction)
        if not (0.0 <= theta <= 180.0 and -360.0 <= phi <= 360.0):
            raise self.refuse(
                "path.region.direction",
                f"[{theta:g}, {phi:g}], outside the sphere",
                "theta_s 0 to 180, phi_s -360 to 360",
            )
        return theta, phi
