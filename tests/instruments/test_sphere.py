"""The integrating sphere: closed forms, integrals of the model, propagated uncertainty."""

import gonio
import numpy as np
import pytest
from gonio import _native
from gonio.port import diffuse_through_port, lobe_through_port, port_capture
from gonio.radiance_colour import luminance
from scipy.interpolate import RegularGridInterpolator


def readings(*, s, rho_d, alpha, port, theta_i=8.0, plug=1.0):
    """What a sphere reads of a plastic: with the plug in the port, and open."""
    through, albedo = lobe_through_port(alpha=alpha, theta_i=theta_i, half_angle=port)
    share = diffuse_through_port(theta_i=theta_i, half_angle=port)
    out = share * rho_d + through * s
    open_ = rho_d + albedo * s - out
    return open_ + plug * out, open_


def in_the_cone(f, *, theta_i, half_angle, n=400):
    """Integral of f cos(theta_s) over the port's cone by midpoints in angle and azimuth about its axis."""
    g = (np.arange(n) + 0.5) * np.radians(half_angle) / n
    chi = (np.arange(n) + 0.5) * 2 * np.pi / n
    g, chi = np.meshgrid(g, chi, indexing="ij")
    i = np.radians(theta_i)
    axis = np.array([-np.sin(i), 0, np.cos(i)])
    x, y = np.array([np.cos(i), 0, np.sin(i)]), np.array([0, 1, 0])
    w = (
        np.cos(g)[..., None] * axis
        + (np.sin(g) * np.cos(chi))[..., None] * x
        + (np.sin(g) * np.sin(chi))[..., None] * y
    )
    theta = np.degrees(np.arctan2(np.hypot(w[..., 0], w[..., 1]), w[..., 2]))
    phi = np.degrees(np.arctan2(w[..., 1], w[..., 0])) % 360
    value = f(theta.ravel(), phi.ravel()).reshape(g.shape) * w[..., 2]
    return float((value * np.sin(g)).sum() * np.radians(half_angle) / n * 2 * np.pi / n)


@pytest.mark.parametrize(("port", "theta_i"), [(1.0, 8.0), (5.0, 8.0), (15.0, 45.0), (20.0, 0.0)])
def test_the_share_of_diffuse_light_is_the_projected_solid_angle_of_the_cone(port, theta_i):
    numeric = in_the_cone(lambda t, _: np.full(t.shape, 1 / np.pi), theta_i=theta_i, half_angle=port)
    assert diffuse_through_port(theta_i=theta_i, half_angle=port) == pytest.approx(numeric, rel=1e-5)


@pytest.mark.parametrize("alpha", [0.02, 0.05, 0.1, 0.2, 0.5])
@pytest.mark.parametrize(
    ("port", "theta_i"), [(2.0, 8.0), (5.0, 8.0), (12.0, 8.0), (20.0, 30.0), (10.0, 60.0)]
)
def test_the_light_of_a_lobe_through_the_port_is_the_integral_of_the_model(alpha, port, theta_i):
    model = _native.analytic([{"model": "ward-gmd", "rho": 1.0, "alpha": alpha}])
    numeric = in_the_cone(
        lambda t, p: model.eval(theta_i=theta_i, phi_i=0.0, theta_s=t, phi_s=p),
        theta_i=theta_i,
        half_angle=port,
    )
    through, _ = lobe_through_port(alpha=alpha, theta_i=theta_i, half_angle=port)
    assert through == pytest.approx(numeric, rel=1e-3)


@pytest.mark.parametrize("alpha", [0.005, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0])
@pytest.mark.parametrize("port", [1.0, 5.0, 10.0, 20.0])
def test_the_closed_form_of_the_share_is_within_a_hundredth_of_the_integral(alpha, port):
    through, _ = lobe_through_port(alpha=alpha, theta_i=8.0, half_angle=port)
    assert port_capture(alpha=alpha, half_angle=port) == pytest.approx(through, abs=0.01)


def test_the_closed_form_gives_the_shares_of_the_literature_for_five_degrees():
    shares = [port_capture(alpha=a, half_angle=5.0) for a in (0.02, 0.05, 0.1, 0.2)]
    assert shares == pytest.approx([0.99, 0.54, 0.18, 0.05], abs=0.01)


def test_a_port_as_wide_as_the_hemisphere_takes_the_whole_lobe():
    through, albedo = lobe_through_port(alpha=0.1, theta_i=0.0, half_angle=90.0)
    assert through == pytest.approx(albedo, rel=1e-5)


@pytest.mark.parametrize("alpha", [0.0, 0.01, 0.05, 0.15])
@pytest.mark.parametrize("plug", [1.0, 0.97])
@pytest.mark.parametrize(("port", "theta_i"), [(4.0, 8.0), (8.0, 8.0), (6.0, 45.0)])
def test_what_a_sphere_reads_of_a_plastic_gives_its_parts_back(alpha, plug, port, theta_i):
    total, open_ = readings(s=0.06, rho_d=0.4, alpha=alpha, port=port, theta_i=theta_i, plug=plug)
    found = gonio.specularity(
        rho_total=total, rho_diffuse=open_, port_half_angle=port, theta_i=theta_i, alpha=alpha, plug=plug
    )
    assert found.specularity == pytest.approx(0.06, rel=1e-9)
    assert found.rho_diffuse == pytest.approx(0.4, rel=1e-9)
    assert found.rho_diffuse + found.rho_lobe == pytest.approx(found.rho_total, rel=1e-12)


def test_a_matt_sample_has_no_specularity_though_light_leaves_through_the_port():
    total, open_ = readings(s=0.0, rho_d=0.8, alpha=0.0, port=6.0)
    assert total - open_ > 0.008
    found = gonio.specularity(rho_total=total, rho_diffuse=open_, port_half_angle=6.0)
    assert found.specularity == pytest.approx(0.0, abs=1e-12)


def test_what_the_sphere_calls_specular_falls_short_of_a_wide_lobe_and_is_told():
    total, open_ = readings(s=0.1, rho_d=0.3, alpha=0.1, port=5.0)
    found = gonio.specularity(rho_total=total, rho_diffuse=open_, port_half_angle=5.0, alpha=0.1)
    assert found.specularity_sphere < 0.2 * found.specularity
    assert any("not Radiance's specularity" in w for w in found.warnings)


def test_a_narrow_lobe_is_taken_whole_and_needs_no_warning():
    total, open_ = readings(s=0.1, rho_d=0.3, alpha=0.01, port=5.0)
    found = gonio.specularity(rho_total=total, rho_diffuse=open_, port_half_angle=5.0, alpha=0.01)
    assert found.specularity_sphere == pytest.approx(0.1, rel=1e-3)
    assert found.warnings == []


def test_without_alpha_the_limit_of_the_result_is_told():
    found = gonio.specularity(rho_total=0.5, rho_diffuse=0.45, port_half_angle=5.0)
    assert any("alpha is not stated" in w and "0.022" in w for w in found.warnings)


def test_the_propagated_uncertainty_is_the_scatter_of_simulated_readings():
    """200,000 draws: the relative standard error of a standard deviation is 0.16 %; 2 % also leaves room for
    the curvature of the result, so that a false alarm is less likely than 1e-9."""
    values = {"rho_total": 0.5, "rho_diffuse": 0.46, "port_half_angle": 5.0, "alpha": 0.04, "plug": 0.98}
    u = {
        "u_rho_total": 0.002,
        "u_rho_diffuse": 0.003,
        "u_port_half_angle": 0.03,
        "u_alpha": 0.0008,
        "u_plug": 0.005,
    }
    correlation = 0.8
    found = gonio.specularity(**values, **u, correlation=correlation)
    rng = np.random.default_rng(20250)
    n = 200_000
    covariance = np.diag([du**2 for du in u.values()])
    covariance[0, 1] = covariance[1, 0] = correlation * u["u_rho_total"] * u["u_rho_diffuse"]
    total, open_, port, alpha, plug = rng.multivariate_normal(list(values.values()), covariance, n).T
    # The two integrals depend on alpha and, through the cone, on the port: interpolated over both.
    ports, alphas = np.linspace(4.8, 5.2, 17), np.linspace(0.035, 0.045, 41)
    table = [[lobe_through_port(alpha=a, theta_i=8.0, half_angle=p) for a in alphas] for p in ports]
    both = RegularGridInterpolator((ports, alphas), np.array(table))(np.stack([port, alpha], axis=1))
    share = diffuse_through_port(theta_i=8.0, half_angle=1.0) / np.sin(np.radians(1.0)) ** 2
    share = share * np.sin(np.radians(port)) ** 2
    out = (total - open_) / plug
    s = (out - share * (open_ + out)) / (both[:, 0] - share * both[:, 1])
    diffuse = open_ + out - both[:, 1] * s
    assert found.u == pytest.approx(s.std(), rel=0.02)
    assert found.u_rho_diffuse == pytest.approx(diffuse.std(), rel=0.02)


def test_correlated_readings_of_one_standard_give_a_smaller_uncertainty():
    given = {
        "rho_total": 0.5,
        "rho_diffuse": 0.46,
        "port_half_angle": 5.0,
        "u_rho_total": 0.003,
        "u_rho_diffuse": 0.003,
    }
    apart, together = (gonio.specularity(**given, correlation=c).u for c in (0.0, 0.95))
    assert together < 0.3 * apart


def test_the_sensitivity_to_alpha_is_the_slope_of_the_result():
    given = {"rho_total": 0.5, "rho_diffuse": 0.46, "port_half_angle": 5.0}
    found = gonio.specularity(**given, alpha=0.06)
    ahead, behind = (gonio.specularity(**given, alpha=a).specularity for a in (0.061, 0.059))
    sensitivity = next(i.sensitivity for i in found.inputs if i.name == "alpha")
    assert sensitivity == pytest.approx((ahead - behind) / 0.002, rel=1e-2)


@pytest.mark.parametrize("material", ["plastic", "metal"])
def test_radiance_parameters_reflect_what_the_sphere_measured(material):
    total, open_ = readings(s=0.06, rho_d=0.4, alpha=0.05, port=5.0)
    p = gonio.specularity(
        rho_total=total,
        rho_diffuse=open_,
        port_half_angle=5.0,
        alpha=0.05,
        rgb=(3.0, 2.0, 1.0),
        material=material,
    ).radiance
    level = luminance([p.red, p.green, p.blue])
    assert level * (1 - p.specularity) == pytest.approx(0.4, rel=1e-9)
    assert p.specularity * (1 if material == "plastic" else level) == pytest.approx(0.06, rel=1e-9)
    assert p.red / p.blue == pytest.approx(3.0)
    assert p.roughness == 0.05


@pytest.mark.parametrize("material", ["plastic", "metal"])
@pytest.mark.parametrize("alpha", [0.02, 0.1])
def test_the_material_of_the_sphere_reflects_the_total_reflectance(material, alpha, tmp_path):
    total, open_ = readings(s=0.06, rho_d=0.4, alpha=alpha, port=5.0)
    given = {"rho_total": total, "rho_diffuse": open_, "port_half_angle": 5.0, "alpha": alpha}
    found = gonio.specularity(**given, rgb=(0.3, 0.2, 0.1), material=material)
    gonio.write_materials(tmp_path / "m.rad", found.radiance.to_material("paint"))
    (back,) = gonio.read_materials(tmp_path / "m.rad")
    assert back.id == "paint"
    model = back.bsdf()
    albedo = [
        _native.directional_albedo(model, theta_i=8.0, phi_i=0.0, component="reflection", channel=c)
        for c in ("red", "green", "blue")
    ]
    assert luminance(albedo) == pytest.approx(total, rel=1e-5)


def test_a_colour_that_no_radiance_material_has_is_told_and_refused():
    found = gonio.specularity(
        rho_total=0.95, rho_diffuse=0.9, port_half_angle=5.0, alpha=0.02, rgb=(1, 0.1, 0.1)
    )
    assert any("above 1" in w for w in found.warnings)
    with pytest.raises(
        gonio.DomainError, match="red above 1: the colour is too saturated for this reflectance"
    ):
        found.radiance.to_material("paint")


def test_a_negative_specularity_is_kept_told_and_not_written():
    found = gonio.specularity(rho_total=0.8, rho_diffuse=0.799, port_half_angle=6.0, rgb=(1, 1, 1))
    assert found.specularity < 0
    assert any("negative" in w for w in found.warnings)
    assert found.radiance.specularity == 0.0


@pytest.mark.parametrize(
    ("changes", "names"),
    [
        ({"rho_total": 55.0}, ("rho_total", "percent")),
        ({"rho_diffuse": float("nan")}, ("rho_diffuse", "nan")),
        ({"u_rho_total": -0.1}, ("u_rho_total",)),
        ({"correlation": 1.5}, ("correlation",)),
        ({"port_half_angle": 0.0}, ("port_half_angle",)),
        ({"theta_i": 85.0, "port_half_angle": 10.0}, ("port_half_angle", "less than 90")),
        ({"alpha": 2.0}, ("alpha",)),
        ({"alpha": 0.8}, ("alpha", "cannot tell them apart")),
        ({"rgb": (0, 0, 0)}, ("rgb",)),
        ({"rgb": (1, -1, 0)}, ("rgb",)),
        ({"material": "wood"}, ("material", "wood")),
    ],
)
def test_what_cannot_be_is_named(changes, names):
    with pytest.raises(gonio.DomainError) as error:
        gonio.specularity(**{"rho_total": 0.5, "rho_diffuse": 0.45, "port_half_angle": 5.0, **changes})
    for name in names:
        assert name in str(error.value)
