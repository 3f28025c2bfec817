"""A model built from readings is measured again, and fitted, as any other model is."""

import gonio
import numpy as np
import pytest
from gonio.materials import Material, material

pytestmark = pytest.mark.slow


def measured(of, folder, seed):
    """What the virtual instrument makes of a material."""
    campaign = gonio.simulate(material=of, out=folder / "raw", seed=seed)
    gonio.process(campaign.sample, beam=campaign.beam, dark=campaign.dark, out=folder / "m")
    return folder / "m"


@pytest.fixture(scope="module")
def loop(tmp_path_factory):
    """A plastic, the model of its readings, the model of the readings of that, and these."""
    first = measured("plastic", tmp_path_factory.mktemp("first"), 11)
    model = gonio.build(first)
    truth = material("plastic")
    again = Material("model", "the model of its readings", model, truth.components, truth.incidences)
    readings = measured(again, tmp_path_factory.mktemp("second"), 12)
    return truth, model, gonio.build(readings), readings


def dsf(model, theta_i):
    """Values over the hemisphere, evenly in projected solid angle."""
    u, v = (np.arange(60) + 0.5) / 60, (np.arange(120) + 0.5) / 120
    theta, phi = np.meshgrid(np.degrees(np.arcsin(np.sqrt(0.995 * u))), 360 * v, indexing="ij")
    return model.eval(theta_i=theta_i, phi_i=0.0, theta_s=theta, phi_s=phi)


@pytest.mark.parametrize("theta_i", [27.0, 55.0, 72.0])
def test_the_model_of_the_readings_of_a_model_is_that_model(loop, theta_i):
    truth, model, second, _ = loop
    first_error = np.abs(dsf(model, theta_i) - dsf(truth.bsdf, theta_i)).sum()
    apart = np.abs(dsf(second, theta_i) - dsf(model, theta_i)).sum()
    size = dsf(truth.bsdf, theta_i).sum()
    assert first_error / size < 0.006
    assert apart / size < 0.006


def test_the_fit_of_the_readings_of_a_model_gives_the_parameters_of_the_truth(loop):
    *_, again = loop
    values = gonio.fit(again, model="lambert + ward-gmd").parameters["photopic"]
    assert values["kd"] == pytest.approx(0.4, rel=0.01)
    assert values["ks"] == pytest.approx(0.08, rel=0.01)
    assert values["alpha"] == pytest.approx(0.15, rel=0.01)
