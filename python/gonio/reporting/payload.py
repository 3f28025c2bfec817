"""The data of the interactive part: typed arrays in base64 inside one JSON block."""

import base64
import json
import math
from typing import Any

import numpy as np
import numpy.typing as npt

from gonio._drawing.directions import SIDES, component_of
from gonio._drawing.mesh import Mesh
from gonio._drawing.shapes import MeasurementLike, Snapshot
from gonio._drawing.thinning import thin_curve
from gonio._native import FLAGS
from gonio.reporting.compare import Reference
from gonio.reporting.drawn import DrawnSlice
from gonio.reporting.wording import channel_label

MOST_OF_A_PROFILE = 3_000
"""Points of one profile, and marks on it, that are drawn."""


def build_payload(
    measurement: MeasurementLike,
    drawn: list[DrawnSlice],
    references: list[Reference],
    truths: dict[tuple[int, str], float | None],
) -> dict[str, Any]:
    """Everything the page's scripts need; `truths` are known integrals by key of the slice and side."""
    channels = list(dict.fromkeys(d.slice.channel for d in sorted(drawn, key=lambda d: d.key)))
    incidences = list(dict.fromkeys(incidence_of(d) for d in drawn))
    sides = [side for side in SIDES if any(side in d.meshes for d in drawn)]
    return {
        "channels": [channel_label(c) for c in channels],
        "incidences": [{"theta_i": theta, "phi_i": phi} for theta, phi in incidences],
        "sides": sides,
        "fwhm": _finite(measurement.signature_fwhm),
        "references": [{"name": r.name, "label": r.label} for r in references],
        "slices": [_slice(d, channels, incidences, references, truths) for d in drawn],
    }


def incidence_of(drawn: DrawnSlice) -> tuple[float, float]:
    """Give the incidence that identifies a slice, degrees, rounded to 1e-4."""
    return round(drawn.slice.theta_i, 4), round(drawn.slice.phi_i, 4)


def to_json(payload: Any) -> str:
    """JSON that may stand inside a script element: no character that HTML gives a meaning."""
    text = json.dumps(payload, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    for character in "<>&\u2028\u2029":
        text = text.replace(character, f"\\u{ord(character):04x}")
    return text


def pack(values: npt.ArrayLike, kind: str) -> str:
    """Base64 of a little-endian array of numpy type `kind` (f4, u2, u1, i4)."""
    return base64.b64encode(
        np.ascontiguousarray(values, dtype=np.dtype(kind).newbyteorder("<")).tobytes()
    ).decode()


def _slice(
    d: DrawnSlice,
    channels: list[str],
    incidences: list[tuple[float, float]],
    references: list[Reference],
    truths: dict[tuple[int, str], float | None],
) -> dict[str, Any]:
    s = d.slice
    profile = d.profile
    line = thin_curve(profile.theta, profile.dsf, most=MOST_OF_A_PROFILE)
    marks = thin_curve(profile.rows_theta, s.dsf[profile.rows], most=MOST_OF_A_PROFILE)
    rows = profile.rows[marks]
    return {
        "channel": channels.index(s.channel),
        "incidence": incidences.index(incidence_of(d)),
        "theta_i": s.theta_i,
        "phi_i": s.phi_i,
        "peak": _finite(d.peak),
        "floor": _finite(d.floor),
        "weak": _weak(s),
        "sides": [_surface(mesh, s) for mesh in d.meshes.values()],
        "integrals": [_integral(i, s.theta_i, truths.get((d.key, str(i.side)))) for i in s.integrals],
        "profile": {
            "phi": profile.plane_phi,
            "tolerance": profile.tolerance,
            "interpolated": profile.interpolated,
            "x": pack(profile.theta[line], "f4"),
            "y": pack(profile.dsf[line], "f4"),
            "u": pack(profile.u_dsf[line], "f4"),
            "marks": {
                "x": pack(profile.rows_theta[marks], "f4"),
                "y": pack(s.dsf[rows], "f4"),
                "u": pack(s.u_dsf[rows], "f4"),
                "noise": pack((s.flags[rows] & FLAGS["below_noise"]) != 0, "u1"),
            },
            "references": {r.name: pack(r.along(s, profile.theta[line]), "f4") for r in references},
        },
    }


def _surface(mesh: Mesh, s: Snapshot) -> dict[str, Any]:
    return {
        "side": mesh.side,
        "component": component_of(s.theta_i, mesh.side),
        "n": len(mesh.rows),
        "theta": pack(s.theta_s[mesh.rows], "f4"),
        "phi": pack(s.phi_s[mesh.rows], "f4"),
        "dsf": pack(s.dsf[mesh.rows], "f4"),
        "triangles": pack(mesh.triangles, "u2" if len(mesh.rows) < 65536 else "i4"),
    }


def _integral(integral: Any, theta_i: float, truth: float | None) -> dict[str, Any]:
    return {
        "component": component_of(theta_i, str(integral.side)),
        "value": _finite(integral.value),
        "extrapolated": _finite(integral.extrapolated),
        "u": _finite(integral.u),
        "truth": _finite(truth),
    }


def _weak(s: Snapshot) -> float | None:
    """Find the DSF that 98 % of the positive readings away from the horizon exceed: where colours may end."""
    away = np.abs(np.cos(np.radians(s.theta_s))) > 0.1
    positive = s.dsf[away & (s.dsf > 0.0) & np.isfinite(s.dsf)]
    return float(np.percentile(positive, 2.0)) if len(positive) else None


def _finite(value: float | None) -> float | None:
    return float(value) if value is not None and math.isfinite(value) else None
