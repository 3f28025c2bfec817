"""Static figures: labels with units, honest gaps, and every kind of measurement."""

import gonio
import matplotlib
import numpy as np
import pytest
from gonio import plotting
from matplotlib import pyplot

from . import samples

matplotlib.use("Agg")
CASES = {name: slices for name, slices in samples.cases().items() if slices}


@pytest.fixture(autouse=True)
def _close_figures():
    yield
    pyplot.close("all")


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize(("quantity", "scale"), [("dsf", "log"), ("bsdf", "linear")])
def test_every_kind_of_measurement_is_drawn_and_saved(name, quantity, scale, tmp_path):
    measurement = samples.measurement(CASES[name])
    for plot in (plotting.plot_profile, plotting.plot_heatmap, plotting.plot_lobe):
        ax = plot(measurement, quantity=quantity, scale=scale)
        ax.figure.savefig(tmp_path / "figure.png", dpi=30)
        pyplot.close("all")
    plotting.plot_dhr(measurement).figure.savefig(tmp_path / "figure.pdf")


def test_the_axes_of_a_profile_carry_units_and_the_range_of_the_extended_angle():
    ax = plotting.plot_profile(samples.measurement([samples.make_slice()]))
    assert "[deg]" in ax.get_xlabel()
    assert ax.get_ylabel() == "DSF [1/sr]"
    assert ax.get_xlim() == (-90.0, 270.0)
    reflection = plotting.plot_profile(samples.measurement([samples.make_slice(back=False)]), quantity="bsdf")
    assert reflection.get_ylabel() == "BSDF [1/sr]"
    assert reflection.get_xlim() == (-90.0, 90.0)


def test_the_axes_of_the_integrals_carry_units():
    ax = plotting.plot_dhr(samples.measurement([samples.make_slice(t) for t in (0.0, 45.0)]))
    assert "[deg]" in ax.get_xlabel()
    assert "[1]" in ax.get_ylabel()
    assert {text.get_text() for text in ax.get_legend().get_texts()} == {"DHR", "DHT", "measured part"}


@pytest.mark.parametrize("plot", [plotting.plot_heatmap, plotting.plot_lobe])
def test_the_colour_bar_of_a_map_or_lobe_carries_units(plot):
    ax = plot(samples.measurement([samples.make_slice()]))
    assert "DSF [1/sr]" in [other.get_ylabel() for other in ax.figure.axes]


def test_the_profile_peaks_at_the_mirror_direction_and_has_the_value_of_the_readings():
    ax = plotting.plot_profile(samples.measurement([samples.make_slice(30.0)]))
    line = next(line for line in ax.lines if line.get_label() == "section through the readings")
    x, y = line.get_xdata(), line.get_ydata()
    front = x < 90.0
    peak = np.nanargmax(np.where(front, y, -np.inf))
    assert x[peak] == pytest.approx(30.0, abs=3.0)
    expected = samples.lobe(30.0, 0.0, np.array([30.0]), np.array([180.0]))[0]
    assert y[peak] == pytest.approx(expected, rel=0.05)


def test_a_detector_shadow_is_a_gap_in_the_profile():
    theta, phi = samples.grid(2.0, back=False)
    source = samples.vectors(40.0, 0.0)
    lit = samples.vectors(theta, phi) @ source < np.cos(np.radians(9.0))
    ax = plotting.plot_profile(
        samples.measurement([samples.make_slice(40.0, theta_s=theta[lit], phi_s=phi[lit])])
    )
    line = next(line for line in ax.lines if line.get_label() == "section through the readings")
    x = line.get_xdata()
    assert not ((x > -46.0) & (x < -34.0)).any()  # the retro direction lies at -40 degrees
    before = np.flatnonzero(x < -46.0).max()
    assert np.isnan(x[before + 1])


def test_negative_readings_are_marked_on_a_logarithmic_scale():
    theta, phi = samples.in_plane()
    dsf = samples.lobe(30.0, 0.0, theta, phi)
    dsf[[3, 50]] = -1e-3
    ax = plotting.plot_profile(samples.measurement([samples.make_slice(theta_s=theta, phi_s=phi, dsf=dsf)]))
    marks = next(line for line in ax.lines if line.get_label() == "negative reading")
    assert len(marks.get_xdata()) == 2
    assert np.all(np.asarray(marks.get_ydata()) > 0.0)


def test_an_incidence_that_was_not_measured_is_an_error_that_names_what_was():
    measurement = samples.measurement([samples.make_slice(30.0)])
    with pytest.raises(gonio.DomainError, match=r"found 45.*\(30°, 0°\) photopic"):
        plotting.plot_profile(measurement, incidence=45.0)
    with pytest.raises(gonio.DomainError, match="found any, channel red"):
        plotting.plot_lobe(measurement, channel="red")


def test_a_figure_is_drawn_into_the_axes_it_is_given():
    _, ax = pyplot.subplots()
    assert plotting.plot_profile(samples.measurement([samples.make_slice()]), ax=ax) is ax
