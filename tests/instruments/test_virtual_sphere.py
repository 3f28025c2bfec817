"""The virtual integrating sphere: files, procedures, integrals of measurements, fits to its readings.

Comparisons with simulated values allow four standard errors: 32 replicates are beyond in 4 of 10,000.
"""

import dataclasses
import re

import gonio
import numpy as np
import pytest
from gonio import _native
from gonio.fit_outputs import save_fit
from gonio.instruments import read_instrument
from gonio.spheres import parse_sphere, read_sphere, spheres

from tests.instruments.surfaces import gaussian_profile

TEXT = """
format = "gonio-sphere 1"
name = "bench"
arrangement = "reflection"
method = "comparison"
theta_i = 8.0
[sphere]
diameter_mm = 300.0
wall = 0.95
[beam]
diameter_mm = 10.0
[sample]
diameter_mm = 25.0
[entrance]
diameter_mm = 25.0
[trap]
diameter_mm = 45.0
[detector]
theta = 90.0
phi = 90.0
diameter_mm = 25.0
[standard]
reflectance = 0.98
[comparison]
theta = 110.0
phi = 270.0
diameter_mm = 25.0
[[baffle]]
between = ["sample", "detector"]
at = 0.6
diameter_mm = 60.0
"""


def plastic(rho_d, s, alpha):
    return _native.analytic(
        [{"model": "lambert", "rho": rho_d}, {"model": "ward-gmd", "rho": s, "alpha": alpha}]
    )


@pytest.mark.parametrize("name", sorted(spheres()))
def test_spheres_that_come_with_gonio_can_be_built_and_read(name):
    found = read_sphere(name)
    assert found.name == name
    sample = (
        plastic(0.4, 0.1, 0.03)
        if found.arrangement == "reflection"
        else _native.analytic(
            [
                {"model": "lambert-transmission", "tau": 0.3},
                {"model": "bounded-transmission-lobe", "tau": 0.3, "alpha": 0.02},
            ]
        )
    )
    m = gonio.sphere(sample, sphere=name, rays=2**13)
    assert m.total.u > 0
    assert m.port is not None
    assert m.port.value > 0
    if found.method != "substitution":
        assert abs(m.total.value - m.model_total) < 4 * m.total.u_rays + 0.01 * m.model_total


@pytest.mark.parametrize(("rho_d", "s", "alpha"), [(0.4, 0.06, 0.01), (0.1, 0.1, 0.05), (0.6, 0.2, 0.1)])
def test_the_procedure_gives_what_a_plastic_sends_into_the_cone_within_two_percent(rho_d, s, alpha):
    m = gonio.sphere(plastic(rho_d, s, alpha), sphere=parse_sphere(TEXT, source="t"), rays=2**17)
    off = m.port.value - m.model_port
    assert abs(off) < 0.02 * m.model_port
    assert abs(m.total.value - m.model_total) < 4 * m.total.u_rays + 0.005
    assert m.diffuse.value == pytest.approx(m.total.value - m.port.value, abs=1e-12)
    # The round cone of the stated half angle stands for the true one, which the spot makes blurred.
    round_cone = gonio.cone_integral(plastic(rho_d, s, alpha), half_angle=m.half_angle)
    assert round_cone == pytest.approx(m.model_port, rel=0.02)


def test_the_standards_uncertainty_is_part_of_that_of_the_result():
    text = TEXT.replace("reflectance = 0.98", "reflectance = 0.98\nu = 0.01")
    m = gonio.sphere(plastic(0.4, 0.1, 0.03), sphere=parse_sphere(text, source="t"), rays=2**12)
    assert m.total.u == pytest.approx(np.hypot(m.total.u_rays, 0.01 * m.total.value))


def test_rays_are_added_until_the_error_is_met():
    m = gonio.sphere(plastic(0.4, 0.1, 0.03), sphere=parse_sphere(TEXT, source="t"), error=1.5e-3)
    assert max(m.total.u_rays, m.port.u_rays) <= 1.5e-3
    assert m.rays >= 2**16


def test_a_method_without_its_port_is_refused_and_substitution_is_told():
    bench = parse_sphere(TEXT, source="t")
    with pytest.raises(gonio.DomainError, match="method: found auxiliary"):
        gonio.sphere("plastic", sphere=bench, method="auxiliary", rays=64)
    m = gonio.sphere("plastic", sphere=bench, method="substitution", rays=64)
    assert any("substitution" in w for w in m.warnings)


@pytest.mark.parametrize(
    ("old", "new", "wanted"),
    [
        ("wall = 0.95", "wall = 1.2", "sphere.wall: found 1.2, allowed a number of 0.05 to 0.999"),
        ("wall = 0.95", "wall = 0.95\nwalls = 2", "sphere.walls: found an unknown key"),
        ("theta_i = 8.0", "theta_i = 1.0", "entrance and trap"),
        ("diameter_mm = 45.0", "diameter_mm = 400.0", "trap.diameter: found 0.4 m, allowed 0.0001 to 0.15"),
        ("theta = 110.0", "theta = 300.0", "comparison.theta"),
        ("theta = 110.0\nphi = 270.0", "theta = 95.0\nphi = 92.0", "detector and comparison"),
        ('["sample", "detector"]', '["sample", "trap"]', "in the beam"),
        ('["sample", "detector"]', '["sample", "window"]', "baffle.between"),
        ("diameter_mm = 60.0", "diameter_mm = 140.0", "baffle"),
        ("diameter_mm = 10.0", "diameter_mm = 30.0", "beam.diameter"),
        ("[standard]\nreflectance = 0.98", "", "standard: found nothing"),
        ('arrangement = "reflection"', 'arrangement = "transmission"', "entrance: found a section"),
        ("at = 0.6", "at = 0.99", "baffle.at"),
        ("name =", "name = = 1", "TOML|Invalid|line"),
    ],
)
def test_a_wrong_file_is_one_clear_error(old, new, wanted):
    with pytest.raises(gonio.FormatError, match=wanted) as told:
        parse_sphere(TEXT.replace(old, new, 1), source="bench.toml")
    assert str(told.value).startswith("bench.toml: ")
    assert "\n" not in str(told.value)


@pytest.fixture(scope="module")
def measured():
    """Readings of a plastic without noise, dense about the mirror direction."""
    return gonio.tabulate(plastic(0.4, 0.1, 0.06), pitch=4, peak_pitch=0.5)


@pytest.mark.parametrize("half_angle", [2.0, 5.0, 10.0])
def test_integrals_of_readings_are_those_of_the_model(measured, half_angle):
    found = gonio.sphere_integrals(measured, half_angle=half_angle, theta_i=10.0)
    wanted = gonio.cone_integral(
        plastic(0.4, 0.1, 0.06), half_angle=half_angle, theta_i=found.theta_i, phi_i=found.phi_i
    )
    assert abs(found.port.value - wanted) < 2 * found.port.u
    assert found.port.u < 0.03 * wanted
    assert found.total.value == pytest.approx(0.4 + 0.1, abs=0.01)
    assert found.diffuse.value == pytest.approx(found.total.value - found.port.value)
    share = found.diffuse_share
    assert found.specularity.value == pytest.approx(
        (found.port.value - share * found.total.value) / (1 - share)
    )


def test_a_cone_without_readings_and_one_below_the_horizon_are_refused(measured):
    with pytest.raises(gonio.DomainError, match="less than 90"):
        gonio.sphere_integrals(measured, half_angle=40.0, theta_i=60.0)
    with pytest.raises(gonio.QuantityError, match="transmission"):
        gonio.sphere_integrals(measured, half_angle=5.0, component="transmission")
    with pytest.raises(gonio.DomainError, match="half_angle"):
        gonio.sphere_integrals(measured, half_angle=0.0)


def test_readings_of_the_sphere_and_a_known_roughness_give_the_plastic_back(tmp_path):
    truth = gonio.materials.radiance("void plastic p 0 0 5 .4 .4 .4 .06 .05")
    m = gonio.sphere(truth, sphere=parse_sphere(TEXT, source="t"), channel="green", rays=2**16)
    path = tmp_path / "readings.toml"
    m.write(path)
    found = gonio.fit_sphere(path, model="plastic", fixed={"alpha": 0.05})
    specularity = found.estimate("specularity")
    assert abs(specularity.value - 0.06) < 4 * specularity.u
    assert specularity.u < 0.01
    total, diffuse = found.sphere
    assert total.half_angle is None
    assert diffuse.half_angle == pytest.approx(m.half_angle)
    assert total.predicted == pytest.approx(m.total.value, abs=1e-4)
    assert total.before is None


def test_a_sphere_beside_a_goniometer_is_compared_and_states_its_cone(measured):
    reading = gonio.SphereReading(total=0.52, u_total=0.001, diffuse=0.5, u_diffuse=0.001, half_angle=3.0)
    found = gonio.fit(measured, model="plastic", sphere=gonio.SphereReadings((reading,)), held_out=False)
    assert found.sphere[0].half_angle is None
    assert found.to_dict()["sphere"][1]["half_angle"] == pytest.approx(3.0)
    assert found.sphere[0].before is not None


@pytest.mark.parametrize(
    ("change", "wanted"),
    [
        ({"u_total": None}, "u_total: found None"),
        ({"half_angle": None}, "half_angle: found none"),
        ({"total": None, "diffuse": None}, "neither total nor diffuse"),
    ],
)
def test_readings_that_say_too_little_are_refused(change, wanted):
    reading = gonio.SphereReading(total=0.5, u_total=0.01, diffuse=0.4, u_diffuse=0.01, half_angle=4.0)
    with pytest.raises(gonio.DomainError, match=re.escape(wanted)):
        gonio.fit_sphere(
            gonio.SphereReadings((dataclasses.replace(reading, **change),)), fixed={"alpha": 0.1}
        )


def test_a_file_of_readings_with_an_unknown_key_is_refused(tmp_path):
    path = tmp_path / "readings.toml"
    path.write_text('format = "gonio-sphere-readings 1"\n[[reading]]\ntotal = 0.5\nu_totl = 0.1\n')
    with pytest.raises(gonio.FormatError, match="u_totl: found an unknown key"):
        gonio.read_sphere_readings(path)


def test_a_sphere_and_a_surface_profile_give_radiances_plastic(tmp_path):
    # The way of the source chapter: specularity from the sphere, roughness from the surface, no goniometer.
    heights = gaussian_profile(n=40_000, step=1.0, sigma=0.25, tau=10.0, seed=3)
    alpha = gonio.roughness(heights, spacing=1.0, x_unit="um", z_unit="um").alpha
    assert alpha == pytest.approx(0.05, rel=0.03)
    truth = gonio.materials.radiance("void plastic p 0 0 5 .5 .5 .5 .08 .05")
    m = gonio.sphere(truth, sphere=parse_sphere(TEXT, source="t"), channel="green", rays=2**16)
    found = gonio.fit_sphere(m.readings_to_fit, model="plastic", fixed={"alpha": alpha})
    s, c = found.estimate("specularity"), found.estimate("color")
    # 3 % of alpha are 4 % of what the port takes of the lobe.
    assert abs(s.value - 0.08) < 4 * s.u + 0.004
    assert abs(c.value - 0.5) < 4 * c.u + 0.004
    saved = save_fit(found, out=tmp_path / "fit", as_visible=True)
    text = (tmp_path / "fit" / "material.rad").read_text()
    assert "material.rad" in saved.files
    assert "plastic" in text
    assert "sphere" in (tmp_path / "fit" / "fit.json").read_text()


def test_a_file_of_another_kind_is_refused_as_such(tmp_path):
    path = tmp_path / "other.toml"
    path.write_text('format = "gonio-instrument 1"\nname = "bench"\n')
    for read in (gonio.read_sphere, gonio.read_sphere_readings):
        with pytest.raises(gonio.FormatError, match="found 'gonio-instrument 1', allowed 'gonio-sphere"):
            read(path)
    path.write_text('format = "gonio-sphere 1"\n')
    with pytest.raises(gonio.FormatError, match="found 'gonio-sphere 1', allowed 'gonio-instrument 1'"):
        read_instrument(path)
    with pytest.raises(gonio.DomainError, match="'plastik', which is no file"):
        gonio.sphere("plastik")
