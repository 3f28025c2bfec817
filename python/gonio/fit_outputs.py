"""The files of a fit: fit.json, the materials of other programs, the residual page."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from gonio import _native
from gonio._native import Bsdf, DomainError, FormatError
from gonio.analytic import analytic
from gonio.checking import MeasurementOrPath
from gonio.files import check_directory, replacing_directory, sha256
from gonio.fit_colour import Palette, Triple
from gonio.fit_materials import MITSUBA, RADIANCE, Substitute, best_material
from gonio.fit_mitsuba import mitsuba_material
from gonio.fit_radiance import radiance_material
from gonio.fit_results import Fit, finite
from gonio.fitting import fit_input
from gonio.measurement import Measurement
from gonio.measurement_header import JSON_NAME as MEASUREMENT_NAME
from gonio.working import Progress, interruptible, silent

FORMAT = "gonio-fit"
FORMAT_VERSION = 1
JSON_NAME = "fit.json"
PAGE_NAME = "residuals.html"
RADIANCE_NAME = "material.rad"
MITSUBA_NAME = "mitsuba.xml"
MITSUBA_DICT_NAME = "mitsuba.json"

FILES = (RADIANCE_NAME, MITSUBA_NAME, MITSUBA_DICT_NAME, PAGE_NAME)
"""Files of an earlier fit that go when a new one does not have them."""


@dataclass(frozen=True)
class SavedFit:
    """What `save_fit` wrote.

    `files` are the names in the directory `out`; `losses` tells, by file, what a material does not hold of
    the fit; `refused` tells, by file, why there is none; `substituted` tells, by file, which other model of
    the ranking it holds where the program has not the fitted one; `notes` tells, by file, what its numbers
    are.
    """

    out: Path
    files: tuple[str, ...]
    losses: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    refused: Mapping[str, str] = field(default_factory=dict)
    substituted: Mapping[str, Substitute] = field(default_factory=dict)
    notes: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "out": os.fspath(self.out),
            "files": list(self.files),
            "losses": {k: list(v) for k, v in self.losses.items()},
            "refused": dict(self.refused),
            "substituted": {k: asdict(v) for k, v in self.substituted.items()},
            "notes": {k: list(v) for k, v in self.notes.items()},
        }


def save_fit(
    fit: Fit,
    *,
    out: str | os.PathLike[str],
    measurement: MeasurementOrPath | None = None,
    name: str | None = None,
    colour: Triple | None = None,
    illuminant: str = "D65",
    as_visible: bool = False,
    force: bool = False,
    progress: Progress = silent,
) -> SavedFit:
    """Write a directory with the fit as data, as materials of other programs and as a page.

    The directory appears whole or not at all: fit.json; material.rad, of the model where it is a Radiance
    material or maps onto one, else of the best ranked model that does; mitsuba.xml and mitsuba.json (the dict
    of `mitsuba.load_dict`) likewise; residuals.html with the measurement. A model whose parameters the
    readings leave open is not written.

    Parameters
    ----------
    fit
        What `gonio.fit` gave.
    out
        The directory; its parent must exist. An earlier fit there is replaced.
    measurement
        What was fitted; without it there is no page.
    name
        Name of the material; None makes one of the sample's name and the model.
    colour
        Red, green, blue in Radiance's primaries at any scale, for a fit of one channel.
    illuminant
        D65, A or E: the light under which wavelengths become a colour.
    as_visible
        Take the one channel of the fit, such as 650nm, for the visible: a grey material.
    force
        Write into a directory that holds other files.
    progress
        Called with stage, parts done and parts in all.

    Raises
    ------
    DomainError
        A colour for channels that have their own, or that is no colour; predictions that do not belong to the
        measurement.
    FormatError
        `out` holds other files and `force` is not set.
    OSError
        The file system refuses.
    """
    check_directory(out, marker=JSON_NAME, force=force)
    Palette(fit.channels, tint=colour, as_visible=as_visible)  # its errors before any work
    sample = None if measurement is None else _sample(fit, measurement)
    losses: dict[str, tuple[str, ...]] = {}
    refused: dict[str, str] = {}
    substituted: dict[str, Substitute] = {}
    names: dict[str, str] = {}
    notes: dict[str, tuple[str, ...]] = {}
    texts: dict[str, str] = {}

    def made(file: str, make: Callable[[], None]) -> None:
        try:
            make()
        except (DomainError, FormatError) as error:
            refused[file] = str(error)

    def label(of: Fit) -> str:
        return word(name or _label(sample, of.model))

    def note(
        file: str,
        of: Fit,
        lost: tuple[str, ...],
        substitute: Substitute | None,
        known: tuple[str, ...] = (),
    ) -> list[str]:
        """Keep what is to be told of a material; the lines of its head."""
        names[file], losses[file] = label(of), lost
        if known:
            notes[file] = known
        if substitute is not None:
            substituted[file] = substitute
        return _head(of, lost, substitute, known)

    def radiance() -> None:
        mapped, of, substitute = best_material(
            fit,
            RADIANCE,
            lambda f: radiance_material(
                f, name=label(f), colour=colour, illuminant=illuminant, as_visible=as_visible
            ),
        )
        lines = note(RADIANCE_NAME, of, mapped.losses, substitute, mapped.notes)
        texts[RADIANCE_NAME] = "".join(f"# {line}\n" for line in lines) + mapped.material.text

    def mitsuba() -> None:
        mapped, of, substitute = best_material(
            fit,
            MITSUBA,
            lambda f: mitsuba_material(f, colour=colour, illuminant=illuminant, as_visible=as_visible),
        )
        lines = note(MITSUBA_NAME, of, mapped.losses, substitute)
        texts[MITSUBA_NAME] = mapped.xml(name=label(of), comments=lines)
        texts[MITSUBA_DICT_NAME] = json.dumps(mapped.material, indent=2) + "\n"

    made(RADIANCE_NAME, radiance)
    made(MITSUBA_NAME, mitsuba)
    told = {
        "names": names,
        "losses": {k: list(v) for k, v in losses.items()},
        "refused": refused,
        "substituted": {k: asdict(v) for k, v in substituted.items()},
        "notes": {k: list(v) for k, v in notes.items()},
    }
    header = {"format": FORMAT, "format_version": FORMAT_VERSION}
    plain = finite(header | fit.to_dict() | {"materials": told})
    texts[JSON_NAME] = json.dumps(plain, indent=2, allow_nan=False) + "\n"
    progress("writing", 0, 1)
    with replacing_directory(out, marker=JSON_NAME, owned=FILES, force=force) as staged:
        for file, text in texts.items():
            (staged / file).write_text(text, encoding="utf-8", newline="\n")
        if sample is not None:
            # Drawing libraries take half a second to load, which every other verb would pay.
            from gonio.reporting.fit_page import render_fit  # noqa: PLC0415

            interruptible(
                lambda: render_fit(
                    fit,
                    sample,
                    out=staged / PAGE_NAME,
                    refused=refused,
                    losses={k: (*_told(substituted.get(k)), *v) for k, v in losses.items()},
                )
            )
            texts[PAGE_NAME] = ""
    progress("writing", 1, 1)
    return SavedFit(Path(out), tuple(sorted(texts)), losses, refused, substituted, notes)


def read_fitted_model(
    path: str | os.PathLike[str], *, measurement: str | os.PathLike[str] | None = None
) -> Bsdf:
    """Read the model of a fit that `save_fit` wrote: a directory, or its fit.json.

    `measurement` is the directory of the measurement to draw it over: a fit of other readings is refused.
    A fit of readings in memory names no file; then its channels have to be those of the measurement.

    Raises
    ------
    FormatError
        It is no file of a fit, or damaged.
    DomainError
        The fit is of another measurement.
    OSError
        The operating system refuses.
    """
    file = Path(path)
    file = file / JSON_NAME if file.is_dir() else file
    try:
        plain = json.loads(file.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise FormatError(f"{file}: found no JSON ({error})") from error
    if not isinstance(plain, dict) or plain.get("format") != FORMAT:
        raise FormatError(f'{file}: found no "format": "{FORMAT}", allowed is a file written by gonio fit')
    if plain.get("format_version") != FORMAT_VERSION:
        raise FormatError(
            f"{file}: format_version: found {plain.get('format_version')!r}, allowed {FORMAT_VERSION}"
        )
    try:
        if measurement is not None:
            _require_same(file, plain, Path(measurement))
        return analytic(*plain["parts"])
    except DomainError:
        raise
    except (KeyError, TypeError, _native.GonioError) as error:
        raise FormatError(f"{file}: found a damaged fit ({error})") from error


def _require_same(file: Path, plain: Mapping[str, Any], measurement: Path) -> None:
    """Refuse the fit `plain` of `file` where it is not of the measurement in that directory."""
    fitted: Mapping[str, Any] = next(
        (i for i in plain["provenance"]["inputs"] if i.get("role") == "measurement"), {}
    )
    header = measurement / MEASUREMENT_NAME
    if "sha256" in fitted and header.is_file():
        here = sha256(header)
        if fitted["sha256"] != here:
            raise DomainError(
                f"{file}: provenance.inputs: found a fit of {fitted.get('path', fitted['name'])} (SHA-256 "
                f"{fitted['sha256'][:12]}…), allowed one of {header} ({here[:12]}…): fit this measurement "
                "with gonio fit"
            )
    elif "sha256" not in fitted:
        channels = Measurement.load(measurement).channels
        other = [c for c in plain["channels"] if c not in channels]
        if other:
            raise DomainError(
                f"{file}: channels: found {', '.join(other)}, allowed those of {measurement}: "
                f"{', '.join(channels)}: fit this measurement with gonio fit"
            )


def _sample(fit: Fit, measurement: MeasurementOrPath) -> Measurement:
    """The readings of the fit, with the uncertainties it was told."""
    stated = {}
    if not isinstance(measurement, Measurement) and Path(measurement).is_file():
        settings = fit.provenance.get("settings", {})
        stated = {name: settings[name] for name in ("u_relative", "u_floor") if name in settings}
    return fit_input(measurement, channels=fit.channels, stated=stated)[0]


def _label(sample: Measurement | None, model: str) -> str:
    """Sample and model, each once."""
    known = (sample.sample_name if sample is not None else None) or ""
    return known if model in known else f"{known} {model}"


def word(text: str) -> str:
    """A name that every program takes: letters, digits and underscores."""
    return re.sub(r"\W+", "_", text, flags=re.ASCII).strip("_").lower() or "material"


def _told(substitute: Substitute | None) -> list[str]:
    """What to know of a substitute."""
    if substitute is None:
        return []
    return [substitute.text] if substitute.warning is None else [substitute.text, substitute.warning]


def _head(
    fit: Fit, losses: tuple[str, ...], substitute: Substitute | None, notes: tuple[str, ...]
) -> list[str]:
    """The head of a material's file: what the numbers are and what they do not hold."""
    lines = [] if substitute is None else [f"note: {substitute.text}"]
    if substitute is not None and substitute.warning is not None:
        lines.append(f"warning: {substitute.warning}")
    lines += [f"gonio fit: {fit.title} ({fit.model}), {fit.readings} readings, {', '.join(fit.channels)}"]
    for e in fit.estimates:
        unit = "" if e.unit == "1" else f" {e.unit}"
        lines.append(f"{e.label} = {e.value:.6g}{unit}, 95 % in {e.low:.4g} to {e.high:.4g} ({e.kind})")
    lines += [f"note: {note}" for note in notes]
    lines += [f"lost: {loss}" for loss in losses]
    lines += [f"warning: {w.text}" for w in fit.warnings]
    return [" ".join(line.split()) for line in lines]
