import gonio
import numpy as np
import pytest


def test_every_model_evaluates_at_its_defaults_and_keeps_to_its_component():
    for model in gonio.models():
        part = {p.name: p.default for p in model.parameters} | {"model": model.name}
        bsdf = gonio.analytic(part)
        reflected = bsdf.eval(theta_i=30, phi_i=0, theta_s=[10, 30, 60], phi_s=180)
        transmitted = bsdf.eval(theta_i=30, phi_i=0, theta_s=[170, 150, 120], phi_s=180)
        assert np.any(reflected > 0) == (model.scatters in ("reflection", "both")), model.name
        assert np.any(transmitted > 0) == (model.scatters in ("transmission", "both")), model.name


def test_compensation_gives_back_the_light_that_facets_lose():
    part = {"f0": 1.0, "alpha": 0.7}
    once, all_of_it = (
        gonio.directional_albedo(gonio.analytic(part | {"model": name}), theta_i=50)
        for name in ("ggx", "ggx-compensated")
    )
    assert once < 0.9
    assert abs(all_of_it - 1) < 0.001


def test_channels_come_from_the_parameters_that_name_them():
    bsdf = gonio.analytic(
        {"model": "lambert", "rho": {"red": 0.5, "green": 0.4, "blue": 0.1}},
        {"model": "ward-gmd", "rho": 0.05, "alpha": 0.1},
    )
    assert bsdf.channels == ["red", "green", "blue"]
    albedo = [
        gonio.directional_albedo(bsdf, theta_i=0, channel=c) - 0.05 * (1 - 0.01 * (1 - np.exp(-100)))
        for c in bsdf.channels
    ]
    # The lobe's albedo at normal incidence in closed form: 1 - alpha^2 (1 - exp(-1/alpha^2)).
    np.testing.assert_allclose(albedo, [0.5, 0.4, 0.1], atol=1e-6)


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ((), "at least one"),
        (({"model": "no-such"},), "lambert"),
        (({"model": "lambert"},), "rho"),
        (({"model": "lambert", "rho": 1.5},), "0 to 1"),
        (({"model": "lambert", "rho": 0.5, "gloss": 1},), "gloss"),
        (({"model": "lambert", "rho": {"red": 0.5}}, {"model": "lambert", "rho": {"blue": 0.5}}), "blue"),
        (({"model": "lambert", "rho": float("nan")},), "0 to 1"),
    ],
)
def test_mistakes_are_named(parts, says):
    with pytest.raises(gonio.DomainError, match=says):
        gonio.analytic(*parts)
