"""The RT-300S reader, on real workbooks where they are at hand."""

import os
from pathlib import Path

import gonio
import numpy as np
import pytest

DATA = (
    Path(os.environ.get("GONIO_SHARED_DATA", Path(__file__).parents[3] / "shared" / "data")) / "loft-rt300s"
)
STEEL = DATA / "NiTE_on_steel_v1o0A_20250915.xls"

needs_data = pytest.mark.skipif(not STEEL.exists(), reason="the shared data are not here")


@needs_data
def test_a_workbook_is_one_scan_an_incidence_in_dsf():
    scans = gonio.read(STEEL)
    assert [round(s.theta_i) for s in scans] == [10, 30, 50, 70]
    assert {len(s) for s in scans} == {19 * 33}
    assert {(s.kind, s.quantity, s.channel) for s in scans} == {("sample", "dsf", "650nm")}
    assert all(s.time[0] == 0 and (np.diff(s.time) > 0).all() for s in scans)


@needs_data
def test_the_readings_peak_at_the_mirror_direction():
    for scan in gonio.read(STEEL)[:3]:
        peak = np.argmax(scan.value)
        wanted = np.radians([scan.theta_i, scan.phi_i + 180])
        found = np.radians([scan.theta_s[peak], scan.phi_s[peak]])
        cosine = np.cos(wanted[0]) * np.cos(found[0]) + np.sin(wanted[0]) * np.sin(found[0]) * np.cos(
            wanted[1] - found[1]
        )
        assert np.degrees(np.arccos(min(cosine, 1.0))) < 11  # tilt, and an off-specular peak at 50 degrees


def value_at(scan, values, theta, phi):
    """Mean of the readings at one direction of the scan's grid."""
    across = np.abs((scan.phi_s - phi + 180) % 360 - 180)
    at = (np.abs(scan.theta_s - theta) < 1e-6) & (across < 1e-6)
    assert at.sum() == 2  # in-plane directions are read from either end of the azimuths
    return values[at].mean()


@needs_data
def test_values_over_the_cosine_are_the_brdf_that_the_authors_published():
    """The authors' Zemax file, the mean of three runs less the blank: 1/sr at the mirror direction."""
    runs = [
        gonio.read(DATA / f"NiTE_on_steel_v1o0{r}.xls") for r in ("A_20250915", "B_20250916", "C_20250916")
    ]
    blank = gonio.read(DATA / "blank_v2o0_20250911.xls", kind="dark")
    assert {s.kind for s in blank} == {"dark"}
    for k, (theta, brdf) in enumerate([(10, 6.039e-2), (30, 7.562e-2)]):
        dsf = np.mean([value_at(r[k], r[k].value - blank[k].value, theta, 0) for r in runs])
        assert dsf / np.cos(np.radians(theta)) == pytest.approx(brdf, rel=0.01)


@needs_data
def test_values_over_the_cosine_are_reciprocal_and_the_values_are_not():
    """Helmholtz reciprocity tells a DSF from a BSDF: the cosine's exponent that makes it hold is 1, not 0."""
    blank = gonio.read(DATA / "blank_v2o0_20250911.xls")
    exponents = []
    for scans in (gonio.read(p) for p in sorted(DATA.glob("[NA]*.xls"))):
        dsf = [s.value - b.value for s, b in zip(scans, blank, strict=True)]
        angles = [round(s.theta_i) for s in scans]
        for a, b in [(0, 2), (0, 3), (1, 3), (2, 3)]:
            forth = value_at(scans[a], dsf[a], angles[b], 0)
            back = value_at(scans[b], dsf[b], angles[a], 0)
            cosines = np.cos(np.radians([angles[b], angles[a]]))
            exponents.append(np.log(forth / back) / np.log(cosines[0] / cosines[1]))
    assert len(exponents) == 16
    assert np.mean(exponents) == pytest.approx(1.0, abs=0.15)
    assert np.ptp(exponents) < 0.3


@needs_data
def test_the_detector_reading_is_there_on_request_and_nothing_else():
    assert gonio.read(STEEL, quantity="signal")[0].value.max() < 1e-7
    with pytest.raises(gonio.QuantityError, match="bsdf"):
        gonio.read(STEEL, quantity="bsdf")


@needs_data
def test_a_cut_workbook_is_a_format_error(tmp_path):
    cut = tmp_path / "cut.xls"
    for size in (8, 600, 50_000, 200_000):
        cut.write_bytes(STEEL.read_bytes()[:size])
        with pytest.raises(gonio.FormatError, match=r"cut\.xls"):
            gonio.read(cut)


def test_what_is_no_workbook_is_a_format_error(tmp_path):
    empty = tmp_path / "empty.xls"
    empty.write_bytes(b"")
    with pytest.raises(gonio.FormatError, match="0 bytes"):
        gonio.read(empty, format="rt300s")
    with pytest.raises(gonio.FormatError, match="0 bytes"):
        gonio.read(empty)
    with pytest.raises(IsADirectoryError):
        gonio.read(tmp_path, format="rt300s")
