import gonio
import numpy as np
import pytest


def lambertian(theta_i, *, rho=0.5, channel="photopic"):
    theta, phi = np.meshgrid(np.arange(2.0, 85.0, 6.0), np.arange(0.0, 360.0, 15.0))
    theta, phi = theta.ravel(), phi.ravel()
    dsf = rho / np.pi * np.cos(np.radians(theta))
    return gonio.Slice(
        theta_i=theta_i,
        phi_i=90.0,
        channel=channel,
        theta_s=theta,
        phi_s=phi,
        dsf=dsf,
        u_dsf=np.zeros_like(dsf),
        omega=np.zeros_like(dsf),
        flags=np.zeros(dsf.shape, dtype=np.uint16),
    )


def test_a_model_is_a_bsdf_in_degrees():
    model = gonio.build(gonio.Measurement([lambertian(t) for t in (10.0, 30.0, 50.0)]))
    assert isinstance(model, gonio.Bsdf)
    assert model.channels == ["photopic"]
    f = model.eval(theta_i=20.0, phi_i=0.0, theta_s=[5.0, 60.0, 89.0], phi_s=33.0)
    np.testing.assert_allclose(f, 0.5 / np.pi, rtol=1e-4)
    assert model.eval(theta_i=20.0, phi_i=0.0, theta_s=120.0, phi_s=0.0) == 0.0
    assert model.loo[0]["theta_i"] == pytest.approx(30.0)
    assert any("not measured" in w and "front transmission" in w for w in model.warnings)


def test_a_missing_channel_and_an_unknown_option_are_named():
    measurement = gonio.Measurement([lambertian(t) for t in (10.0, 30.0)])
    with pytest.raises(gonio.QuantityError, match=r"found red, allowed .*photopic"):
        gonio.build(measurement, channel="red")
    with pytest.raises(gonio.DomainError, match="symmetry"):
        gonio.build(measurement, symmetry="cubic")
    with pytest.raises(gonio.DomainError, match="naive"):
        gonio.build(measurement, candidate="magic")


def test_one_incidence_is_not_enough():
    with pytest.raises(gonio.FitError, match="found 1"):
        gonio.build(gonio.Measurement([lambertian(10.0)]))
