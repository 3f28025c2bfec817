"""Instrument files: what they mean, and one clear error for each that is wrong."""

import numpy as np
import pytest
from gonio import DomainError, FormatError
from gonio.instrument_spectra import WAVELENGTH, Channel, Lamp, f1_prime, outputs, v_lambda
from gonio.instruments import parse_instrument, presets, read_instrument

GOOD = """
format = "gonio-instrument 1"
name = "bench"
[lamp]
kind = "laser"
wavelength = 532
power = 500
[beam]
focus = "detector"
profile = "top-hat"
radius = 0.2
spot_diameter_mm = 8
[holder]
sample_diameter_mm = 20
radius_mm = 100
[detector]
distance_mm = 500
aperture_diameter_mm = 10
[path]
pitch_across = 4
[[path.region]]
around = "direction"
direction = [30, 90]
radius = 5
pitch = 0.5
"""


def parsed(old="", new=""):
    assert old in GOOD
    return parse_instrument(GOOD.replace(old, new, 1) if old else GOOD, source="I.toml")


def test_a_file_gives_the_settings_of_the_core_in_metres_and_degrees():
    it = parsed()
    assert it.settings["distance"] == 0.5
    assert it.settings["spot_diameter"] == 0.008
    assert it.settings["beam_radius"] == 0.2
    assert "beam_half_width" not in it.settings
    assert it.settings["aperture"] == pytest.approx(np.degrees(np.arctan(5 / 500)))
    assert it.settings["sample_diameter"] == 0.02
    assert it.parts["regions"] == [("direction", (30.0, 90.0), (5.0, 0.5, 0.0, 0.6))]
    assert it.lamp.power[WAVELENGTH == 532.0] == 1.0


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "power = 500",
            "power = 500\ncolour = 3",
            r"I.toml: lamp.colour: found an unknown key, allowed kind,",
        ),
        ("[path]", "[paths]\n[path]", r"I.toml: paths: found an unknown key"),
        ("power = 500", "", r"I.toml: lamp.power: found nothing, allowed a number of"),
        ("power = 500", "power = true", r"I.toml: lamp.power: found True"),
        ("power = 500", "power = nan", r"I.toml: lamp.power: found nan"),
        ("power = 500", "power = ", r"I.toml: Invalid value"),
        ("wavelength = 532", "", r"I.toml: lamp.wavelength: found nothing, allowed one with kind laser"),
        ("radius = 0.2", "half_width = 0.2", r"I.toml: beam.radius: found half_width"),
        ("= 20\n", "= 5\n", r"I.toml: holder.overfill: found a sample of 5 mm smaller than the spot of 8 mm"),
        (
            "distance_mm = 500",
            "distance_mm = 90",
            r"I.toml: detector.distance_mm: found 90, inside the sample",
        ),
        ("[30, 90]", "[200, 90]", r"I.toml: path.region.direction: found \[200, 90\], outside the sphere"),
        ("radius = 5", "radius = 95", r"I.toml: path.region.radius: found 95, allowed a number of 0.1 to 90"),
        ("direction = [30, 90]", "", r"I.toml: path.region.direction: found nothing"),
        ("[path]", "[path]\ntable = 'none.csv'", r"I.toml: path.table: found none.csv: No such file"),
        ("format", "# format", r"I.toml: format: found nothing, allowed gonio-instrument 1"),
    ],
)
def test_a_wrong_file_is_one_error_that_names_file_and_key(old, new, message):
    with pytest.raises(FormatError, match=message):
        parsed(old, new)


def test_consent_lets_the_spot_pass_the_sample():
    it = parsed("sample_diameter_mm = 20", "sample_diameter_mm = 5\noverfill = true")
    assert it.settings["overfill"] == 1.0


def test_presets_are_listed_and_read():
    assert set(presets()) == {"RT-300S-like", "in-plane", "pgII-like"}
    for name in presets():
        assert read_instrument(name).name == name
    with pytest.raises(DomainError, match="allowed a file, or one of"):
        read_instrument("pgIII")


def test_a_condenser_lens_images_its_source():
    optics = """[optics]
source_diameter_mm = 2
focal_length_mm = 150
aperture_diameter_mm = 30
lens_to_sample_mm = 250
[holder]"""
    text = GOOD.replace("radius = 0.2\nspot_diameter_mm = 8", "").replace("[holder]", optics)
    text = text.replace("sample_diameter_mm = 20", "sample_diameter_mm = 50")
    it = parse_instrument(text, source="I.toml")
    # b = 750 mm, magnification 4: an image of 8 mm at 500 mm; the cone from 30 to 8 mm a third of the way.
    assert it.settings["beam_radius"] == pytest.approx(np.degrees(np.arctan(4 / 500)))
    assert it.settings["spot_diameter"] == pytest.approx(0.030 * 500 / 750 + 0.008 * 250 / 750)
    on_sample = parse_instrument(text.replace('"detector"', '"sample"'), source="I.toml")
    assert on_sample.settings["spot_diameter"] == pytest.approx(0.002 * (250 / 150 - 1))
    assert on_sample.settings["beam_radius"] == pytest.approx(np.degrees(np.arctan(15 / 250)))


def test_a_detector_sees_the_mean_over_lamp_and_responsivity():
    flat = Lamp("table", np.ones_like(WAVELENGTH))
    band = Channel("550nm", np.where((WAVELENGTH >= 500) & (WAVELENGTH <= 600), 1.0, 0.0), 2.0)
    ((name, power, weights),) = outputs([band], lamp=flat, of=["500nm", "700nm", "600nm"])
    assert (name, power) == ("550nm", 2.0)
    np.testing.assert_allclose(weights, [0.5, 0.0, 0.5], atol=1e-12)
    assert outputs([band], lamp=flat, of=["photopic"])[0][2] == [1.0]
    photopic = Channel("photopic", v_lambda(), 1.0)
    weights = outputs([photopic], lamp=flat, of=["red", "green", "blue"])[0][2]
    assert sum(weights) == pytest.approx(1.0)
    with pytest.raises(DomainError, match="beyond the model's 500 to 520 nm"):
        outputs([band], lamp=flat, of=["500nm", "520nm"])


def test_the_mismatch_index_is_zero_for_v_lambda_and_grows_with_a_shift():
    assert f1_prime(v_lambda()) < 1e-12
    assert 0.01 < f1_prime(v_lambda(1.0)) < f1_prime(v_lambda(3.0)) < 0.1
