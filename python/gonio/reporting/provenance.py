"""Provenance: whatever was recorded of files, versions and settings, as tables a person can read."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from gonio._drawing.numbers import number


def find(provenance: Any, names: tuple[str, ...]) -> str | None:
    """Find the first plain value under one of `names`, at any depth, nearest to the top first."""
    level: list[Any] = [provenance]
    while level:
        below: list[Any] = []
        for node in level:
            if isinstance(node, Mapping):
                for name in names:
                    value = node.get(name)
                    if isinstance(value, str | int | float) and not isinstance(value, bool) and str(value):
                        return str(value)
                below.extend(node.values())
            elif isinstance(node, Sequence) and not isinstance(node, str | bytes):
                below.extend(node)
        level = below
    return None


def sample_file(provenance: Any) -> str | None:
    """Name of the sample's file without its ending, when there is exactly one."""
    inputs = provenance.get("inputs") if isinstance(provenance, Mapping) else None
    if inputs is None or not _records(inputs):
        return None
    names = [str(i.get("name", "")) for i in inputs if i.get("role") == "sample"]
    return (names[0].rsplit(".", 1)[0] or None) if len(names) == 1 else None


def sections(provenance: Any) -> list[dict[str, Any]]:
    """Lay out the provenance: a table for plain values, one a nested mapping, one a list of records."""
    if not isinstance(provenance, Mapping):
        return []
    plain = [(str(k), _text(v)) for k, v in provenance.items() if not _nested(v)]
    tables: list[dict[str, Any]] = []
    if plain:
        tables.append({"title": "General", "pairs": plain})
    for key, value in provenance.items():
        tables.extend(_tables(_title(key), value))
    return tables


def _tables(title: str, value: Any) -> list[dict[str, Any]]:
    """Lay out one entry; lists of records inside a mapping become tables of their own, named after both."""
    if isinstance(value, Mapping) and value:
        own = {k: v for k, v in value.items() if not _records(v) and v is not None}
        if unset := [str(k) for k, v in value.items() if v is None]:
            own["not set"] = unset
        below = [
            t for k, v in value.items() if _records(v) for t in _tables(f"{title}: {_title(k).lower()}", v)
        ]
        return ([{"title": title, "pairs": _pairs(own)}] if own else []) + below
    if _records(value):
        names = list(dict.fromkeys(str(k) for record in value for k in record))
        if all(str(record.get("path", "")).endswith(str(record.get("name"))) for record in value):
            names = [name for name in names if name != "name"]
        rows = [[_text(record.get(name, "")) for name in names] for record in value]
        return [{"title": f"{title} ({len(rows)})", "names": names, "rows": rows}]
    return []


def _pairs(mapping: Mapping[Any, Any], prefix: str = "") -> list[tuple[str, str]]:
    out: list[tuple[str, str]] = []
    for key, value in mapping.items():
        name = f"{prefix}{key}"
        out.extend(
            _pairs(value, f"{name} / ") if isinstance(value, Mapping) and value else [(name, _text(value))]
        )
    return out


def _nested(value: Any) -> bool:
    return (isinstance(value, Mapping) and bool(value)) or _records(value)


def _records(value: Any) -> bool:
    return (
        isinstance(value, Sequence)
        and not isinstance(value, str | bytes)
        and bool(value)
        and all(isinstance(item, Mapping) for item in value)
    )


def _title(key: Any) -> str:
    text = str(key).replace("_", " ")
    return text[:1].upper() + text[1:]


def _text(value: Any) -> str:
    if value is None:
        return "—"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return number(value, 6) if math.isfinite(value) else "no value"
    if isinstance(value, Sequence) and not isinstance(value, str | bytes):
        return ", ".join(_text(item) for item in value)
    return str(value)
