import gonio
import numpy as np
import pytest
from gonio import _native

HALF_WHITE = {"model": "lambert", "rho": 0.5}


@pytest.fixture
def model():
    return _native.analytic([HALF_WHITE])


def test_arguments_broadcast_as_in_numpy(model):
    f = model.eval(theta_i=np.zeros((4, 1)), phi_i=0.0, theta_s=[10.0, 20.0, 100.0], phi_s=0.0)
    assert f.shape == (4, 3)
    np.testing.assert_allclose(f, np.broadcast_to([0.5 / np.pi, 0.5 / np.pi, 0.0], (4, 3)))


def test_scalars_give_an_array_without_dimensions(model):
    assert model.eval(theta_i=0.0, phi_i=0.0, theta_s=1.0, phi_s=0.0).shape == ()


@pytest.mark.parametrize(
    ("changes", "name"), [({"theta_i": 181.0}, "theta_i"), ({"theta_s": [0.0, np.nan]}, "theta_s"),
                          ({"phi_s": np.inf}, "phi_s")]
)  # fmt: skip
def test_an_angle_out_of_range_is_named(model, changes, name):
    with pytest.raises(gonio.DomainError, match=name):
        model.eval(**{"theta_i": 0.0, "phi_i": 0.0, "theta_s": 0.0, "phi_s": 0.0, **changes})


def test_shapes_that_do_not_broadcast_are_an_error(model):
    with pytest.raises(ValueError, match="broadcast"):
        model.eval(theta_i=np.zeros(3), phi_i=0.0, theta_s=np.zeros(4), phi_s=0.0)


def test_an_unknown_channel_is_named(model):
    with pytest.raises(gonio.QuantityError, match="532nm"):
        model.eval(theta_i=0.0, phi_i=0.0, theta_s=0.0, phi_s=0.0, channel="532nm")


def test_sampled_weights_average_to_the_albedo(model):
    u = np.random.default_rng(5).random((200_000, 3))
    found = model.sample(theta_i=30.0, phi_i=0.0, u=u)
    # Five standard errors of the mean: one false alarm in two million.
    error = found["weight"].std() / np.sqrt(len(u))
    assert found["weight"].mean() == pytest.approx(0.5, abs=5 * error + 1e-12)
    drawn = found["weight"] > 0
    pdf = model.pdf(theta_i=30.0, phi_i=0.0, theta_s=found["theta_s"][drawn], phi_s=found["phi_s"][drawn])
    np.testing.assert_allclose(pdf, found["pdf"][drawn], rtol=1e-9)


@pytest.mark.parametrize("u", [np.zeros((4, 2)), np.zeros(3), np.ones((1, 3)), np.full((1, 3), np.nan)])
def test_random_numbers_of_wrong_shape_or_range_are_refused(model, u):
    with pytest.raises(gonio.DomainError, match="u: found"):
        model.sample(theta_i=0.0, phi_i=0.0, u=u)
