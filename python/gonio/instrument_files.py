"""Instruments written as TOML files with a path given reading by reading."""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gonio._native import DomainError
from gonio.instrument_sections import SECTIONS
from gonio.instruments import Instrument

BESIDE = (("beam", "table"), ("lamp", "spectrum"))
"""Keys that name a file beside the instrument's."""

RESPONSES = ("V(lambda)", "gaussian", "flat")
"""Responses that are no files."""


def write_on_path(instrument: Instrument, *, table: str, out: Path) -> None:
    """Write `instrument` with the path of the file `table` beside it, its own tables copied.

    The path keeps `theta_max` alone. Settings that replaced those of the file are written in their place.

    Raises
    ------
    DomainError
        The instrument does not come from a file or preset.
    OSError
        The file system refuses.
    """
    if not instrument.described:
        raise DomainError("instrument: found one that was not read from a file, allowed a file or a preset")
    keys = {k: dict(v) if isinstance(v, Mapping) else v for k, v in instrument.described.items()}
    for section, names in SECTIONS.items():
        for name, key in names.items():
            if not key.setting or section not in keys or key.setting not in instrument.settings:
                continue
            value = instrument.settings[key.setting] / key.factor
            if name in keys[section] or value != key.default:
                keys[section][name] = bool(value) if isinstance(key.default, bool) else value
    _agree(keys, instrument)
    keys["path"] = {"theta_max": instrument.settings["theta_max"], "table": table}
    for section, name in BESIDE:
        if isinstance(keys.get(section, {}).get(name), str):
            keys[section][name] = _copied(instrument, keys[section][name], out.parent)
    channels = [dict(c) for c in keys["detector"].get("channel", [])]
    for channel in channels:
        if channel["response"] not in RESPONSES:
            channel["response"] = _copied(instrument, channel["response"], out.parent)
    if channels:
        keys["detector"]["channel"] = channels
    out.write_text(_toml(keys), encoding="utf-8")


def _agree(keys: dict[str, Any], instrument: Instrument) -> None:
    """Leave out what says the same in two ways."""
    keys["detector"].pop("aperture_diameter_mm", None)
    beam = keys["beam"]
    for shape, name, setting in (
        ("gaussian", "half_width", "beam_half_width"),
        ("top-hat", "radius", "beam_radius"),
    ):
        if setting in instrument.settings:
            beam["profile"] = shape
        else:
            beam.pop(name, None)
    if {"beam_half_width", "beam_radius"} & set(instrument.settings):
        beam.pop("table", None)
        keys.pop("optics", None)
    if "tilt_x" in instrument.settings or "tilt_y" in instrument.settings:
        keys["holder"]["tilt"] = [instrument.settings.get(k, 0.0) for k in ("tilt_x", "tilt_y")]


def _copied(instrument: Instrument, name: str, directory: Path) -> str:
    source = instrument.directory / name
    shutil.copyfile(source, directory / source.name)
    return source.name


def _toml(keys: Mapping[str, Any]) -> str:
    """Text of keys, sections one level deep and lists of sections within them."""
    lines = [f"{k} = {_value(v)}" for k, v in keys.items() if not isinstance(v, Mapping)]
    for section, values in keys.items():
        if not isinstance(values, Mapping):
            continue
        lines += ["", f"[{section}]"]
        lines += [f"{k} = {_value(v)}" for k, v in values.items() if not _rows(v)]
        for name, rows in values.items():
            for row in rows if _rows(rows) else ():
                lines += ["", f"[[{section}.{name}]]"]
                lines += [f"{k} = {_value(v)}" for k, v in row.items()]
    return "\n".join(lines) + "\n"


def _rows(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and isinstance(value[0], Mapping)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, list):
        return "[" + ", ".join(_value(v) for v in value) + "]"
    return f"{value:.12g}" if isinstance(value, float) else str(value)
