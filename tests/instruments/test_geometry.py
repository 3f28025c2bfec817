"""The BSDF of parts that exist as geometry."""

import math
from pathlib import Path

import gonio
import numpy as np
import pytest

PLATE = """void plastic grey
0
0
5 .4 .4 .4 0 0
grey polygon plate
0
0
12 0 0 0 1 0 0 1 1 0 0 1 0
"""


@pytest.fixture
def plate(tmp_path):
    path = tmp_path / "plate.rad"
    path.write_text(PLATE)
    return path


def test_a_grey_plate_is_written_and_read_back(plate, tmp_path):
    found = gonio.simulate_geometry(plate, periodic=True, basis="quarter", error=0.05)
    assert max(found.relative_error.values()) <= 0.05
    mean = found.means["front", "reflection"].luminance.mean()
    assert mean == pytest.approx(0.4 / math.pi, rel=0.02)
    assert found.model.albedo(side="back", component="reflection") == pytest.approx(0.4, rel=0.1)
    out = tmp_path / "plate.xml"
    found.write(out, name="plate")
    model = gonio.read_bsdf(out)
    assert np.allclose(
        model.albedo(side="front", component="reflection"),
        found.model.albedo(side="front", component="reflection"),
        rtol=1e-4,
    )


def test_a_coloured_plate_keeps_its_colours(tmp_path):
    path = tmp_path / "red.rad"
    path.write_text(PLATE.replace(".4 .4 .4", ".8 .2 .1"))
    found = gonio.simulate_geometry(path, periodic=True, basis="quarter", rays=4096, sides=["front"])
    rgb = found.means["front", "reflection"].values.mean(axis=(0, 1)) * math.pi
    assert rgb == pytest.approx([0.8, 0.2, 0.1], rel=0.02)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"basis": "third"}, "basis: found third, allowed full, half, quarter"),
        ({"sides": []}, "sides: found none"),
        ({"error": 0.0}, "error: found 0.0, allowed above 0"),
        ({"window": (0, 0, 2, 2)}, "window: found 0 0 2 2, allowed x_low y_low x_high y_high within 0 0 1 1"),
        (
            {"window": (0, 0, 1000, 1000), "periodic": True},
            "allowed x_low y_low x_high y_high of one period, in the unit of the part",
        ),
        ({"window": (3, 3, 4, 4), "periodic": True}, "window: found 3 3 4 4"),
        ({"window": (0, 0, 1)}, "window: found (0, 0, 1)"),
        ({"rays": 0}, "rays: found 0"),
    ],
)
def test_what_cannot_be_is_refused(plate, arguments, words):
    with pytest.raises(gonio.DomainError) as error:
        gonio.simulate_geometry(plate, **arguments)
    assert words in str(error.value)


EXAMPLES = Path(__file__).parents[2] / "examples" / "geometry"


@pytest.mark.parametrize(
    ("name", "window", "reflected", "through"),
    [
        ("slats", (0, 0, 0.01, 0.01), 0.304, 0.256),
        ("prism", (0, 0, 0.05, 0.05), 0.889, 0.111),
        ("weave", (0, 0, 1, 1), 0.349, 0.166),
    ],
)
def test_examples_are_read_and_have_the_albedo_they_had(name, window, reflected, through):
    found = gonio.simulate_geometry(
        EXAMPLES / f"{name}.rad", window=window, periodic=True, basis="half", rays=256, sides=["front"]
    )
    assert found.warnings == []
    for component, wanted in (("reflection", reflected), ("transmission", through)):
        albedo = found.model.albedo(side="front", component=component)[0]
        # 256 rays: .03 of all light, three times.
        assert albedo == pytest.approx(wanted, abs=0.09)


GLOSSY = """void plastic sheet
0
0
5 .3 .3 .3 .05 .15
sheet polygon plate
0
0
12 -40 -40 0 40 -40 0 40 40 0 -40 40 0
"""
QUICK = {"pitch_across": 10.0, "pitch_along": 5.0, "noise_relative": 0.01, "patch_pitch": 1.0}


def test_readings_of_a_plate_become_the_dsf_of_its_material(tmp_path):
    path = tmp_path / "sheet.rad"
    path.write_text(GLOSSY)
    campaign = gonio.simulate_readings(
        path, out=tmp_path / "scan", unit=1e-3, incidences=[(40.0, 0.0)], settings=QUICK
    )
    assert campaign.monte_carlo[0].above < 0.02
    found = gonio.process(list(campaign.sample), beam=list(campaign.beam), dark=list(campaign.dark))
    (s,) = found.slices
    model = gonio.read_bsdf(path)
    f = model.eval(theta_i=40.0, phi_i=0.0, theta_s=s.theta_s, phi_s=s.phi_s, channel="green")
    truth = f * np.cos(np.radians(s.theta_s))
    # The lobe is wide against the instrument: 95 % of the values lie within two uncertainties.
    held = np.abs(s.dsf - truth) <= 2.0 * s.u_dsf
    assert held.mean() > 0.92
    notes = (tmp_path / "scan" / "campaign.json").read_text()
    assert "monte_carlo" in notes


def test_a_sample_smaller_than_the_spot_is_refused_without_consent(plate, tmp_path):
    with pytest.raises(gonio.DomainError, match="sample smaller than the spot"):
        gonio.simulate_readings(plate, out=tmp_path / "scan", unit=1e-3)
    assert not (tmp_path / "scan").exists()
    with pytest.raises(gonio.DomainError, match="no more than the spot"):
        gonio.simulate_readings(plate, out=tmp_path / "scan", periodic=True, unit=1.0)
    with pytest.raises(OSError, match="nowhere"):
        gonio.simulate_readings(tmp_path / "nowhere.rad", out=tmp_path / "scan")
