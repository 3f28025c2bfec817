"""The data-driven model on NIST's sintered PTFE [Germer2017]."""

import gonio
import numpy as np
import pytest

from .places import SHARED

FOLDER = SHARED / "nist-ptfe-mountain"


@pytest.fixture(scope="module")
def measurement():
    files = sorted(FOLDER.glob("ptfe_532nm_i*.txt"))
    if not files:
        pytest.skip(f"no NIST PTFE data in {FOLDER}")
    return gonio.process(files)


@pytest.fixture(scope="module")
def model(measurement):
    return gonio.build(measurement)


@pytest.mark.parametrize("wavelength", [351, 532, 633, 1064])
def test_every_interior_incidence_is_predicted_from_the_others_within_1_6_per_cent(wavelength):
    files = sorted(FOLDER.glob(f"ptfe_{wavelength}nm_i*.txt"))
    if not files:
        pytest.skip(f"no NIST PTFE data in {FOLDER}")
    model = gonio.build(gonio.process(files))
    errors = {round(e["theta_i"]): e["rel_rms"] for e in model.loo}
    assert set(errors) == {15, 30, 45, 60}
    assert max(errors.values()) <= 0.016


def test_the_expansion_halves_the_largest_error_of_the_linear_interpolation(measurement, model):
    linear = gonio.build(measurement, candidate="naive")
    assert model.loo_error <= 0.5 * linear.loo_error


def test_a_matte_sample_is_interpolated_by_a_reciprocal_expansion(model):
    assert model.summary[0]["candidate"].startswith("model x ratio")
    assert model.summary[0]["base"].startswith("Zernike expansion")
    assert model.summary[0]["bilateral"]


def test_the_albedo_exceeds_one_nowhere(model):
    albedo = [model.albedo(theta_i=theta, phi_i=0.0) for theta in range(0, 90, 2)]
    assert max(albedo) <= 1.0
    assert min(albedo) >= 0.95


def test_the_readings_come_back_at_their_incidence(measurement, model):
    for s in measurement.slices:
        f = model.eval(theta_i=s.theta_i, phi_i=s.phi_i, theta_s=s.theta_s, phi_s=s.phi_s)
        inside = s.theta_s < 80
        assert np.sqrt(np.mean((f[inside] / s.bsdf[inside] - 1) ** 2)) < 0.015


def test_the_coverage_follows_the_incidences(model):
    codes = model.coverage(
        theta_i=[30.0, 37.0, 80.0, 30.0], phi_i=270.0, theta_s=[40.0, 40.0, 40.0, 140.0], phi_s=10.0
    )
    assert [gonio.building.COVERAGE[k] for k in codes] == [
        "measured",
        "interpolated",
        "extrapolated",
        "missing",
    ]
