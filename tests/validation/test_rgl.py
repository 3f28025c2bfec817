"""RGL materials mean to gonio what they mean to Mitsuba, and become measurements that keep their energy."""

import gonio
import numpy as np
import pytest

from .rgl import FILES, ours, pairs, relative, synthetic, theirs, write_tensor_file

PAIRS = 2000


@pytest.fixture(scope="module")
def mitsuba():
    package = pytest.importorskip("mitsuba", reason="mitsuba has no wheel for this platform")
    package.set_variant("scalar_rgb")
    return package


@pytest.fixture(params=FILES, ids=lambda f: f.split("/")[-1].removesuffix("_rgb.bsdf"))
def path(request, shared):
    file = shared / request.param
    if not file.exists():
        pytest.skip(f"{request.param} is not on this machine")
    return file


def test_real_materials_mean_the_same(mitsuba, path):
    wi, ws = pairs(PAIRS, 1)
    f, density = ours(gonio.read_bsdf(path), wi, ws)
    their_f, their_density = theirs(mitsuba, path, wi, ws)
    # Mitsuba computes in single precision: where tables hold next to nothing the coordinate on their square
    # is the difference of nearly equal numbers, so that rare pairs towards the horizon differ by more
    for a, b in ((f, their_f), (density, their_density)):
        error = relative(a, b, floor=1e-6)
        assert np.median(error) < 2e-6
        assert np.quantile(error, 0.999) < 1e-3
        assert error.max() < 1e-2


@pytest.mark.parametrize(
    "phi_i",
    [
        # with one azimuth Mitsuba takes the symmetry from a division by zero; two state the whole turn
        [-np.pi, np.pi],
        np.linspace(-np.pi, np.pi, 7),
        np.linspace(-np.pi, 0, 5),
        np.linspace(-np.pi, -np.pi / 2, 4),
    ],
    ids=["isotropic", "whole turn", "half turn", "quarter turn"],
)
def test_synthetic_materials_mean_the_same(mitsuba, tmp_path, phi_i):
    path = tmp_path / "a.bsdf"
    write_tensor_file(path, synthetic(phi_i, None))
    wi, ws = pairs(PAIRS, 2)
    model = gonio.read_bsdf(path)
    f, density = ours(model, wi, ws)
    their_f, their_density = theirs(mitsuba, path, wi, ws)
    assert model.properties["isotropic"] == (len(phi_i) == 2)
    assert relative(f, their_f, floor=1e-6).max() < 1e-3
    assert np.quantile(relative(density, their_density, floor=1e-6), 0.999) < 1e-3


def test_spectral_materials_mean_the_same(mitsuba, tmp_path):
    path = tmp_path / "a.bsdf"
    wavelengths = [400.0, 500.0, 600.0, 700.0]
    write_tensor_file(path, synthetic(np.linspace(-np.pi, np.pi, 7), wavelengths))
    wi, ws = pairs(200, 3)
    model = gonio.read_bsdf(path)
    assert model.channels == ["400nm", "500nm", "600nm", "700nm"]
    f, _ = ours(model, wi, ws)
    mitsuba.set_variant("scalar_spectral")
    try:
        their_f, _ = theirs(mitsuba, path, wi, ws, wavelengths)
    finally:
        mitsuba.set_variant("scalar_rgb")
    assert relative(f, their_f, floor=1e-6).max() < 1e-3


def test_samples_of_real_materials_follow_their_density(path):
    """Mean of 1 / pdf over samples in a cone is its solid angle, within 4 standard errors."""
    model = gonio.read_bsdf(path)
    rng = np.random.default_rng(4)
    for theta_i in (15.0, 45.0, 70.0):
        drawn = model.sample(theta_i=theta_i, phi_i=30.0, u=rng.random((100_000, 3)))
        good = drawn["pdf"] > 0
        theta, phi = np.radians(drawn["theta_s"][good]), np.radians(drawn["phi_s"][good])
        ws = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=1)
        t, p = np.radians([theta_i, 210.0])
        axis = np.array([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)])
        radius = np.radians(4.0)
        inverse = np.where(ws @ axis > np.cos(radius), 1 / drawn["pdf"][good], 0)
        inverse = np.concatenate([inverse, np.zeros(np.count_nonzero(~good))])
        expected = 2 * np.pi * (1 - np.cos(radius))
        assert abs(inverse.mean() - expected) < 4 * inverse.std() / np.sqrt(len(inverse))


def test_the_measurement_of_a_material_keeps_its_albedo(path):
    """DHR of the measurement against the albedo by sampling, four standard errors of which are allowed.

    Directions without data hold what RGL made up, and the measurement extrapolates them in its own way.
    """
    model = gonio.read_bsdf(path)
    measurement = gonio.tabulate(path, channels=["red"])
    assert [s.theta_i for s in measurement.slices] == pytest.approx(model.measured_theta_i.tolist())
    u = np.random.default_rng(5).random((100_000, 3))
    for s in measurement.slices:
        drawn = model.sample(theta_i=s.theta_i, phi_i=0.0, u=u)
        weight, good = drawn["weight"], drawn["weight"] > 0
        known = np.zeros(len(weight), bool)
        known[good] = model.has_data(
            theta_i=s.theta_i, phi_i=0.0, theta_s=drawn["theta_s"][good], phi_s=drawn["phi_s"][good]
        )
        albedo, without = weight.mean(), (weight * ~known).mean()
        made_up = max(without, s.integrals[0].extrapolated)
        allowed = 0.005 * albedo + made_up + 4 * weight.std() / np.sqrt(len(weight))
        assert without < 0.04 * albedo, s.theta_i
        assert s.integrals[0].value == pytest.approx(albedo, abs=allowed), s.theta_i


def test_data_end_where_the_files_end(path):
    model = gonio.read_bsdf(path)
    assert 75 < model.measured_theta_i[-1] < 82
    assert model.theta_i[-1] == pytest.approx(90, abs=1e-4)
    at = {"phi_i": 0.0, "theta_s": [10.0, 60.0], "phi_s": 120.0}
    assert model.has_data(theta_i=40.0, **at).all()
    assert not model.has_data(theta_i=model.measured_theta_i[-1] + 0.1, **at).any()
    s = gonio.tabulate(model, channels=["red"], incidences=[(45, 0)]).slices[0]
    assert 70 < s.theta_s.max() <= 88
    with pytest.raises(gonio.DomainError, match="no data"):
        gonio.tabulate(model, incidences=[(85, 0)])
