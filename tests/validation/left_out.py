"""Incidences of real measurements that a model never saw: errors of the prediction, and what is stated."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gonio
import numpy as np
from gonio import _native

from .places import SHARED

COATINGS = {
    "NiTE on steel, A": "NiTE_on_steel_v1o0A_20250915.xls",
    "NiTE on steel, B (turned by 45°)": "NiTE_on_steel_v1o0B_20250916.xls",
    "NiTE on steel, C (turned by 90°)": "NiTE_on_steel_v1o0C_20250916.xls",
    "AnoBlack EC1 on aluminium": "ANOPLATE_AnoBlack_EC1_Alum6061_v1o0_20251115.xls",
}
BLANK = "blank_v2o0_20250911.xls"
SPHERE = SHARED / "ansys-formats" / "test_13_planesymmetric_brdf_zemax.bsdf"


def coating(name: str) -> Path:
    """The file of a black coating, read on an RT-300S."""
    return SHARED / "loft-rt300s" / COATINGS[name]


def blank() -> Path:
    """The dark readings of that instrument."""
    return SHARED / "loft-rt300s" / BLANK


@dataclass(frozen=True)
class Dropped:
    """What came of predicting an incidence from the others."""

    rel_l1: float
    """Sum of |f' - f| over that of |f|, DSF by solid angle, over the readings dropped."""
    stated: float
    candidate: str
    base: str | None
    warnings: list[str]


def without(measurement: gonio.Measurement, theta_i: float) -> Dropped:
    """Build from all incidences but `theta_i` (degrees) and predict its readings."""
    slices = measurement._data.slices
    dropped = [abs(s.theta_i - theta_i) < 1 for s in slices]
    (held,) = [s for s, out in zip(slices, dropped, strict=True) if out]
    rest: Any = [s for s, out in zip(slices, dropped, strict=True) if not out]
    model = _native.build(_native.MeasurementData(rest))
    f = model.eval(theta_i=held.theta_i, phi_i=held.phi_i, theta_s=held.theta_s, phi_s=held.phi_s)
    dsf, omega = np.asarray(held.dsf), np.asarray(held.omega)
    apart = np.abs(np.asarray(f).reshape(-1) * np.cos(np.radians(held.theta_s)) - dsf)
    stated = model.stated_error(theta_i=held.theta_i, phi_i=held.phi_i)
    assert stated is not None
    assert stated["total"] is not None
    summary = model.summary[0]
    return Dropped(
        rel_l1=float((omega * apart).sum() / (omega * np.abs(dsf)).sum()),
        stated=stated["total"],
        candidate=summary["candidate"],
        base=summary["base"],
        warnings=model.warnings,
    )
