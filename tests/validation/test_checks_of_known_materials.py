"""The checks on simulated campaigns of sound materials, measured soundly: none objects."""

import gonio
import pytest
from gonio.materials import MATERIALS

SYMMETRIES = {"brushed": "quadrilateral"}


def verdicts_of(name, seed, tmp_path):
    campaign = gonio.simulate(material=name, seed=seed, out=tmp_path / "raw")
    measurement = gonio.process(campaign.sample, beam=campaign.beam, dark=campaign.dark)
    return {v.id: v for v in gonio.check(measurement)}


def assert_sound(name, verdicts):
    objections = [(v.id, v.verdict, v.sentence) for v in verdicts.values() if v.verdict in ("warn", "fail")]
    assert not objections
    # A reciprocal sample differs by its uncertainty: noise of 0.8 % and what is left of the interpolation.
    assert 0.3 < verdicts["reciprocity"].value < 2.0, verdicts["reciprocity"].sentence
    assert abs(verdicts["quantity"].value) < 0.1
    expected = SYMMETRIES.get(name, "symmetric about the plane of incidence")
    assert expected in verdicts["symmetry"].sentence


def test_a_satin_metal_of_steep_lobes_passes_every_check(tmp_path):
    verdicts = verdicts_of("metal", 1, tmp_path)
    assert_sound("metal", verdicts)
    assert "Noise about zero" in verdicts["negative_readings"].sentence


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("name", sorted(MATERIALS))
def test_no_check_objects_to_a_sound_campaign(name, seed, tmp_path):
    assert_sound(name, verdicts_of(name, seed, tmp_path))
