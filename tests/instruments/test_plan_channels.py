"""A plan for several detectors that read at once."""

import dataclasses

import gonio
import pytest
from gonio import _native
from gonio.instruments import read_instrument
from gonio.materials import Material


@pytest.fixture(scope="module")
def coloured() -> Material:
    """Diffuse to the first detector, glossy to the second, dark to the third."""
    bsdf = gonio.analytic(
        {"model": "lambert", "rho": {"red": 0.5, "green": 0.1, "blue": 0.0}},
        {"model": "ward-gmd", "rho": {"red": 0.0, "green": 0.4, "blue": 0.0}, "alpha": 0.06},
    )
    return Material("coloured", "diffuse red, glossy green", bsdf, ("reflection",), ((30.0, 0.0),))


def test_every_detector_that_sees_light_meets_the_targets(coloured, tmp_path):
    # Without filters of its own: one detector a channel of the material.
    instrument = dataclasses.replace(read_instrument("pgII-like"), channels=())
    plan = gonio.plan(coloured, instrument=instrument)
    assert plan.channels == ("red", "green", "blue")
    assert plan.met
    (scan,) = plan.scans
    assert {scan.channel_integral, scan.channel_peak} <= {"red", "green"}
    assert max(scan.u_integral, scan.error) <= 0.005
    assert scan.u_peak <= 0.01
    # The first detector sees no lobe, the second does.
    (lobe,) = scan.lobes
    assert lobe.at == pytest.approx((30.0, 180.0), abs=0.5)
    (path,) = plan.path
    table = [((30.0, 0.0), list(zip(path.theta_s.tolist(), path.phi_s.tolist(), strict=True)))]
    parts = {k: v for k, v in instrument.parts.items() if k != "regions"}
    campaign = gonio.simulate(
        material=coloured,
        instrument=dataclasses.replace(instrument, parts={**parts, "table": table}),
        seed=8,
        out=tmp_path / "raw",
    )
    measured = gonio.process(
        campaign.sample, beam=campaign.beam, dark=campaign.dark, u_calibration=instrument.u_calibration
    )
    lit = [s for s in measured.slices if s.channel != "blue"]
    assert len(lit) == 2
    for s in lit:
        (integral,) = s.integrals
        whole = _native.directional_albedo(
            coloured.bsdf, theta_i=30.0, phi_i=0.0, component="reflection", channel=s.channel
        )
        assert abs(integral.value / whole - 1.0) <= 2 * 0.005, s.channel
        assert integral.u <= 0.006 * integral.value, s.channel
        _, top, u, _ = s.highest("front")
        assert u <= 0.012 * top, s.channel
