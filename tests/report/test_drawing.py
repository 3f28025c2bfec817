"""What the drawings are made of: triangulation, thinning and numbers."""

import numpy as np
import pytest
from gonio._drawing.mesh import triangulate
from gonio._drawing.numbers import number, percent, with_uncertainty
from gonio._drawing.section import section
from gonio._drawing.thinning import thin, thin_curve

from . import samples


def solid_angle(mesh):
    a, b, c = (mesh.vectors[mesh.triangles[:, k]] for k in range(3))
    triple = np.abs(np.einsum("ij,ij->i", a, np.cross(b, c)))
    dots = 1.0 + np.sum(a * b, 1) + np.sum(b * c, 1) + np.sum(c * a, 1)
    return float(np.sum(2.0 * np.arctan2(triple, dots)))


def test_a_full_hemisphere_is_covered_and_nothing_beyond_its_last_ring():
    theta, phi = samples.grid(3.0, back=False, limit=84.0)
    mesh = triangulate(samples.make_slice(theta_s=theta, phi_s=phi), "front")
    cap = 2.0 * np.pi * (1.0 - np.cos(np.radians(84.0)))
    assert solid_angle(mesh) == pytest.approx(cap, rel=2e-3)


def test_a_hole_stays_open():
    theta, phi = samples.grid(3.0, back=False)
    away = samples.vectors(theta, phi) @ samples.vectors(30.0, 50.0) < np.cos(np.radians(12.0))
    whole = triangulate(samples.make_slice(theta_s=theta, phi_s=phi), "front")
    holed = triangulate(samples.make_slice(theta_s=theta[away], phi_s=phi[away]), "front")
    hole = 2.0 * np.pi * (1.0 - np.cos(np.radians(12.0)))
    assert solid_angle(whole) - solid_angle(holed) > 0.8 * hole


def test_thinning_keeps_the_hole_the_peak_and_the_budget():
    rng = np.random.default_rng(11)
    theta, phi = np.degrees(np.arccos(rng.uniform(0.05, 1.0, 40_000))), rng.uniform(0.0, 360.0, 40_000)
    source = samples.vectors(40.0, 0.0)
    lit = samples.vectors(theta, phi) @ source < np.cos(np.radians(7.0))
    theta, phi = theta[lit], phi[lit]
    slice_ = samples.make_slice(theta_s=theta, phi_s=phi, dsf=samples.lobe(40.0, 0.0, theta, phi, alpha=0.02))
    mesh = triangulate(slice_, "front")
    thinned = thin(mesh, slice_.dsf, most=3_000, floor=1e-4)
    assert len(thinned.rows) <= 3_002
    assert slice_.dsf[thinned.rows].max() == slice_.dsf.max()
    centres = thinned.vectors[thinned.triangles].mean(axis=1)
    centres /= np.linalg.norm(centres, axis=1, keepdims=True)
    assert not (centres @ source > np.cos(np.radians(4.0))).any()
    assert solid_angle(thinned) == pytest.approx(solid_angle(mesh), rel=0.03)


def test_readings_in_one_plane_give_no_surface_but_a_profile():
    theta, phi = samples.in_plane()
    slice_ = samples.make_slice(theta_s=theta, phi_s=phi)
    assert len(triangulate(slice_, "front").triangles) == 0
    profile = section(slice_)
    assert not profile.interpolated
    drawn = profile.theta[np.isfinite(profile.theta)]
    assert len(drawn) == len(theta)
    assert not ((drawn > -35.0) & (drawn < -25.0)).any()


def test_a_section_crosses_the_readings_linearly():
    theta, phi = samples.grid(4.0, back=False)
    flat = samples.vectors(theta, phi)[:, 2] * 0.3
    profile = section(samples.make_slice(50.0, 20.0, theta_s=theta, phi_s=phi, dsf=flat))
    good = np.isfinite(profile.theta)
    expected = 0.3 * np.cos(np.radians(profile.theta[good]))
    np.testing.assert_allclose(profile.dsf[good], expected, atol=0.3 * (1.0 - np.cos(np.radians(4.0))))


def test_a_thinned_curve_keeps_its_extremes_and_its_gaps():
    theta = np.linspace(-90.0, 90.0, 10_000)
    values = np.sin(theta)
    values[[4_321, 7_777]] = [9.0, -9.0]
    theta[5_000], values[5_000] = np.nan, np.nan
    rows = thin_curve(theta, values, most=500)
    assert len(rows) <= 501
    assert {4_321, 7_777, 5_000} <= set(rows.tolist())
    assert np.all(np.diff(rows) > 0)


@pytest.mark.parametrize(
    ("value", "u", "written"),
    [
        (0.98123, 0.00205, "0.9812 ± 0.0041"),
        (0.98123, 0.0499, "0.98 ± 0.10"),
        (12.3, 0.3, "12.30 ± 0.60"),
        (-0.5, 0.01, "−0.500 ± 0.020"),
        (1.2e-6, 2e-8, "(1.200 ± 0.040)·10⁻⁶"),
        (3.0, 120.0, "3 ± 240"),
        (0.5, 0.0, "0.5000"),
        (0.5, float("nan"), "0.5000"),
        (float("nan"), 1.0, "no value"),
    ],
)
def test_a_value_is_rounded_to_its_uncertainty(value, u, written):
    assert with_uncertainty(value, u) == written


def test_numbers_are_written_as_a_laboratory_writes_them():
    assert number(4.1e-4, 2) == "4.1·10⁻⁴"
    assert number(-0.5, 2) == "−0.50"
    assert number(None) == "no value"
    assert percent(-0.00001) == "0.00 %"
