"""Where numbers come from: input files with their hashes, versions, settings, time."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from gonio._native import __version__
from gonio.files import sha256


def input_file(path: str | os.PathLike[str], *, role: str) -> dict[str, Any]:
    """Name, size, SHA-256 and role (sample, beam, dark, standard) of an input file."""
    file = Path(path)
    return {
        "name": file.name,
        "path": os.fspath(file),
        "role": role,
        "bytes": file.stat().st_size,
        "sha256": sha256(file),
    }


def provenance(*, inputs: Iterable[Mapping[str, Any]], settings: Mapping[str, Any]) -> dict[str, Any]:
    """Provenance of a result made now by this version of gonio."""
    return {
        "gonio": __version__,
        "python": platform.python_version(),
        "created": datetime.now(UTC).isoformat(timespec="seconds"),
        "inputs": [dict(i) for i in inputs],
        "settings": dict(settings),
    }
