"""Colour: closed forms, Radiance's convention, and what other programs make of the same spectra."""

import json
import subprocess
import sys

import colour
import gonio
import numpy as np
import pytest
from gonio.colours import ILLUMINANTS, colours_of_spectra
from gonio.radiance_colour import RGB_TO_XYZ, luminance, rgb_of_srgb, rgb_of_xyz
from gonio.spectra import read_spectra

from tests.validation.places import SHARED

WAVELENGTHS = np.arange(360.0, 781.0, 5.0)


def of(spectrum, wavelengths=WAVELENGTHS, **options):
    return colours_of_spectra(wavelengths, np.asarray(spectrum)[:, None], names=["s"], **options)[0]


def smooth(seed):
    """A smooth spectrum between 0 and 1, as a function of the wavelength."""
    rng = np.random.default_rng(seed)
    centres, widths, heights = rng.uniform(380, 720, 3), rng.uniform(40, 90, 3), rng.uniform(0.1, 0.3, 3)
    return lambda w: (
        0.05
        + sum(h * np.exp(-(((w - c) / b) ** 2)) for c, b, h in zip(centres, widths, heights, strict=True))
    )


def test_the_luminance_weights_are_those_of_radiance():
    # Radiance's source has 0.3333 for 1/3, which the last digits show.
    np.testing.assert_allclose(RGB_TO_XYZ[1], [0.265074, 0.670115, 0.064811], rtol=5e-4)
    assert luminance([1.0, 1.0, 1.0]) == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("illuminant", ILLUMINANTS)
@pytest.mark.parametrize("level", [0.0, 0.18, 1.0])
def test_a_neutral_spectrum_is_grey_under_every_light(illuminant, level):
    found = of(np.full(len(WAVELENGTHS), level), illuminant=illuminant)
    np.testing.assert_allclose(found.rgb, level, atol=1e-12)
    assert found.photopic == pytest.approx(level, abs=1e-12)
    assert found.warnings == []


@pytest.mark.parametrize("seed", range(5))
def test_under_equal_energy_the_luminance_of_the_rgb_is_the_photopic_value(seed):
    found = of(smooth(seed)(WAVELENGTHS), illuminant="E")
    assert min(found.rgb_unclipped) > 0
    # The published observer's sums differ in the fifth digit, so that its E is not (1, 1, 1) exactly.
    assert found.luminance == pytest.approx(found.photopic, rel=1e-4)


@pytest.mark.filterwarnings("ignore:Aligning:colour.utilities.ColourRuntimeWarning")
@pytest.mark.parametrize("illuminant", ILLUMINANTS)
@pytest.mark.parametrize("interval", [5.0, 10.0])
def test_tristimulus_values_are_those_of_colour_science(illuminant, interval):
    """Its Sprague interpolation and ASTM E308 summation differ from monotone cubics by less than 1e-4."""
    at = np.arange(360.0, 781.0, interval)
    for seed in range(5):
        spectrum = smooth(seed)(at)
        theirs = colour.sd_to_XYZ(
            colour.SpectralDistribution(spectrum, at),
            cmfs=colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"],
            illuminant=colour.SDS_ILLUMINANTS[illuminant],
        )
        np.testing.assert_allclose(of(spectrum, at, illuminant=illuminant).xyz, theirs / 100, atol=1e-4)


def test_the_adaptation_is_that_of_colour_science():
    found = of(smooth(1)(WAVELENGTHS), illuminant="A")
    white = of(np.ones(len(WAVELENGTHS)), illuminant="A").xyz
    adapted = colour.adaptation.chromatic_adaptation_VonKries(
        np.array(found.xyz), np.array(white), np.ones(3), transform="Sharp"
    )
    np.testing.assert_allclose(RGB_TO_XYZ @ found.rgb_unclipped, adapted, rtol=1e-6)


def test_a_coarse_spectrum_gives_the_colour_of_the_fine_one():
    fine, coarse = (
        of(smooth(2)(w), w) for w in (np.arange(380.0, 781.0, 1.0), np.arange(380.0, 781.0, 20.0))
    )
    np.testing.assert_allclose(coarse.rgb, fine.rgb, atol=3e-3)


def test_the_range_of_a_colorimeter_is_taken_with_the_share_it_leaves_out():
    w = np.arange(400.0, 701.0, 10.0)
    found = of(np.full(len(w), 0.5), w)
    assert found.photopic == pytest.approx(0.5, abs=1e-12)
    assert any("leave out 0.29 %" in text for text in found.warnings)


@pytest.mark.parametrize(
    ("wavelengths", "names"),
    [
        (np.arange(450.0, 651.0, 5.0), ("450 to 650", "410 to 690")),
        (np.array([380.0, 400.0, 500.0, *np.arange(520.0, 781.0, 20.0)]), ("gap from 400 to 500", "20 nm")),
        (np.array([550.0]), ("1 wavelength",)),
    ],
)
def test_wavelengths_that_do_not_carry_a_colour_are_refused(wavelengths, names):
    with pytest.raises(gonio.FormatError) as error:
        of(np.full(len(wavelengths), 0.5), wavelengths)
    for name in names:
        assert name in str(error.value)


def test_a_colour_outside_the_gamut_is_clipped_and_told():
    laser = np.where(np.abs(WAVELENGTHS - 500.0) < 8, 0.9, 0.01)
    found = of(laser)
    assert min(found.rgb) == 0.0 > min(found.rgb_unclipped)
    assert any("gamut" in w for w in found.warnings)


def test_values_above_one_and_below_zero_are_kept_and_told():
    spectrum = smooth(3)(WAVELENGTHS)
    spectrum[40] = 1.2
    assert any("0 to 1" in w for w in of(spectrum).warnings)
    assert of(2 * spectrum).photopic == pytest.approx(2 * of(spectrum).photopic, rel=1e-12)


def test_a_photopic_channel_alone_is_grey():
    found = gonio.colour_of_channels({"photopic": 0.42})
    assert (found.rgb, found.source) == ((0.42, 0.42, 0.42), "photopic")


def test_rgb_channels_are_the_rgb():
    found = gonio.colour_of_channels({"photopic": 0.3, "red": 0.4, "green": 0.3, "blue": 0.2})
    assert (found.rgb, found.source) == ((0.4, 0.3, 0.2), "rgb")
    assert any("differs" in w for w in found.warnings)


def test_linear_srgb_becomes_radiances_rgb_as_colour_science_has_it():
    space = colour.RGB_COLOURSPACES["sRGB"]
    srgb = np.random.default_rng(1).random((20, 3))
    white = colour.xy_to_XYZ(space.whitepoint)
    xyz = colour.RGB_to_XYZ(srgb, space, apply_cctf_decoding=False)
    # The tabulated matrix of the standard has four digits.
    np.testing.assert_allclose(rgb_of_srgb(srgb), rgb_of_xyz(xyz, white=white), atol=2e-4)
    np.testing.assert_allclose(rgb_of_srgb(np.full(3, 0.4)), 0.4, atol=1e-12)


def test_channels_of_linear_srgb_are_converted():
    values = {"red": 0.6, "green": 0.3, "blue": 0.1}
    found = gonio.colour_of_channels(values, primaries="sRGB")
    np.testing.assert_allclose(found.rgb, rgb_of_srgb(np.array([0.6, 0.3, 0.1])), atol=1e-12)
    assert np.abs(np.array(found.rgb) - [0.6, 0.3, 0.1]).max() > 1e-3
    with pytest.raises(gonio.DomainError, match="primaries: found 'ACES', allowed Radiance, sRGB"):
        gonio.colour_of_channels(values, primaries="ACES")


def test_wavelength_channels_are_a_spectrum():
    channels = {f"{w:g}nm": float(smooth(4)(w)) for w in np.arange(400.0, 701.0, 20.0)}
    by_hand = of([v for v in channels.values()], np.arange(400.0, 701.0, 20.0))
    found = gonio.colour_of_channels({"photopic": 0.2, **channels})
    assert found.rgb == by_hand.rgb


@pytest.mark.parametrize(
    ("channels", "names"),
    [
        ({}, ("none",)),
        ({"red": 0.2, "green": 0.3}, ("red, green", "together")),
        ({"532nm": 0.2}, ("532nm", "span the visible")),
        ({"photopic": float("nan")}, ("photopic", "nan")),
        ({"450nm": 0.1, "650nm": 0.2}, ("450 to 650",)),
    ],
)
def test_channels_without_a_colour_are_refused(channels, names):
    with pytest.raises(gonio.GonioError) as error:
        gonio.colour_of_channels(channels)
    for name in names:
        assert name in str(error.value)


def test_an_unknown_illuminant_is_named():
    with pytest.raises(gonio.DomainError, match="illuminant: found 'D50', allowed D65, A, E"):
        of(np.ones(len(WAVELENGTHS)), illuminant="D50")


@pytest.mark.parametrize("package", ["colour", "scipy", "sdfio"])
def test_what_only_other_instruments_need_loads_when_they_come(package):
    code = (
        f"import sys, gonio; gonio.colour_of_channels({{'photopic': 0.3}}); print('{package}' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "False"


def file_of(name):
    path = SHARED / name
    if not path.is_file():
        pytest.skip(f"{path} is not here: measured data are not part of the project")
    return path


def test_the_glass_of_the_igsdb_has_the_photopic_values_stated_there():
    stated = json.loads(file_of("lbnl-igsdb/igsdb_v2_clear_3.json").read_text())
    values = stated["integrated_spectral_averages_summaries"][0]["photopic"]
    front, back = (float(values[f"reflectance_{side}"]["direct_direct"]) for side in ("front", "back"))
    through = float(values["transmittance_front"]["direct_direct"])
    found = gonio.colour(file_of("lbnl-igsdb/CLEAR_3.DAT"))
    # The table holds four digits.
    assert [c.photopic for c in found] == pytest.approx([through, front, back], abs=5e-5)


def test_wavelengths_in_micrometres_are_understood_from_the_header():
    spectra = read_spectra(file_of("lbnl-igsdb/CLEAR_3.DAT"))
    assert (spectra.wavelength[0], spectra.wavelength[-1]) == (300.0, 2500.0)


def test_spectralon_is_white():
    for name in ("Spectralon_Num4.txt", "Spectralon-panel-4-diffuse-reflectance_2023Jan18.txt"):
        found = gonio.colour(file_of(f"grit-spectralon/{name}"), columns=["2"])[0]
        assert 0.97 < found.photopic < 1.0
        assert max(found.rgb) - min(found.rgb) < 0.002
