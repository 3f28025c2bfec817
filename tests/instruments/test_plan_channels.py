"""A plan for several detectors that read at once."""

import dataclasses

import gonio
import pytest
from gonio.instruments import read_instrument
from gonio.materials import Material


@pytest.fixture(scope="module")
def coloured() -> Material:
    """Diffuse to the first detector, glossy to the second, dark to the third."""
    bsdf = gonio.analytic(
        [
            {"model": "lambert", "rho": {"red": 0.5, "green": 0.1, "blue": 0.0}},
            {"model": "ward-gmd", "rho": {"red": 0.0, "green": 0.4, "blue": 0.0}, "alpha": 0.06},
        ]
    )
    return Material("coloured", "diffuse red, glossy green", bsdf, ("reflection",), ((30.0, 0.0),))


def test_every_detector_that_sees_light_meets_the_targets(coloured):
    # Without filters of its own: one detector a channel of the material.
    instrument = dataclasses.replace(read_instrument("pgII-like"), channels=())
    plan = gonio.plan(coloured, instrument=instrument)
    assert plan.channels == ("red", "green", "blue")
    assert plan.met
    (scan,) = plan.scans
    # Only the second sees a lobe; what it sees is the harder to integrate.
    assert scan.channel_integral == scan.channel_peak == "green"
    (lobe,) = scan.lobes
    assert lobe.at == pytest.approx((30.0, 180.0), abs=0.5)
    red = Material(
        "red", "", gonio.analytic({"model": "lambert", "rho": 0.5}), ("reflection",), ((30.0, 0.0),)
    )
    assert plan.readings > 2 * gonio.plan(red, instrument=instrument).readings
    assert max(scan.u_integral, scan.error) <= 0.005
    assert scan.u_peak <= 0.01
