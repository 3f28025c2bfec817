"""Roughness: surfaces of known height and correlation length, filters, uncertainty, warnings."""

import gonio
import numpy as np
import pytest
from gonio.surface_filters import SIGMA_OF_CUTOFF, correlation_length, gaussian, levelled, slope

from tests.instruments.surfaces import gaussian_map, gaussian_profile

UM = {"x_unit": "um", "z_unit": "um"}


@pytest.mark.parametrize(("sigma", "tau"), [(1.0, 10.0), (2.0, 8.0), (0.8, 15.0)])
def test_alpha_of_a_gaussian_map_is_twice_sigma_over_tau(sigma, tau):
    """Four standard uncertainties: a false alarm in 16,000 seeds."""
    z = gaussian_map(n=1024, step=1.0, sigma=sigma, tau=tau, seed=3)
    found = gonio.roughness(z, spacing=1.0, **UM)
    assert abs(found.alpha - 2 * sigma / tau) < 4 * found.u_alpha < 0.04 * found.alpha
    assert found.alpha == found.rms_slope
    assert abs(found.rms - sigma) < 4 * found.u_rms < 0.08 * sigma
    assert found.alpha_of_length == pytest.approx(2 * sigma / tau, rel=0.05)


@pytest.mark.parametrize(("sigma", "tau"), [(1.0, 10.0), (0.5, 5.0)])
def test_alpha_of_a_gaussian_profile_is_root_two_times_its_rms_slope(sigma, tau):
    z = gaussian_profile(n=100_000, step=1.0, sigma=sigma, tau=tau, seed=4)
    found = gonio.roughness(z, spacing=1.0, **UM)
    assert found.rms_slope == pytest.approx(np.sqrt(2) * sigma / tau, rel=0.02)
    assert found.alpha == pytest.approx(2 * sigma / tau, rel=0.02)
    assert found.correlation_length[0] == pytest.approx(tau, rel=0.05)


def test_the_tilts_of_a_surface_are_those_of_the_beckmann_lobe_of_its_alpha():
    """Points of a map are even in projected area: the share up to a tilt is 1 - exp(-tan²(tilt) / alpha²).

    With √2 sigma / tau in its place the median tilt would be off by a factor √2.
    """
    z = gaussian_map(n=1024, step=1.0, sigma=1.5, tau=10.0, seed=20)
    alpha = gonio.roughness(z, spacing=1.0, **UM).alpha
    y, x = np.gradient(z)
    tangent = np.hypot(x, y)
    for share in (0.1, 0.5, 0.9, 0.99):
        predicted = alpha * np.sqrt(-np.log1p(-share))
        assert np.quantile(tangent, share) == pytest.approx(predicted, rel=0.03)


def test_a_row_of_an_isotropic_map_tells_the_alpha_of_the_map():
    z = gaussian_map(n=1024, step=1.0, sigma=1.0, tau=6.0, seed=5)
    whole = gonio.roughness(z, spacing=1.0, **UM).alpha
    rows = [gonio.roughness(z[k], spacing=1.0, **UM).alpha for k in range(0, 1024, 128)]
    assert np.sqrt(np.mean(np.square(rows))) == pytest.approx(whole, rel=0.05)


@pytest.mark.parametrize("azimuth", [0.0, 30.0, 90.0, 135.0])
def test_a_lay_gives_both_widths_and_the_azimuth_of_the_steeper(azimuth):
    z = gaussian_map(n=1024, step=1.0, sigma=1.0, tau=8.0, tau_y=24.0, azimuth=azimuth, seed=6)
    found = gonio.roughness(z, spacing=1.0, **UM)
    assert found.alpha_x == pytest.approx(2 / 8, rel=0.04)
    assert found.alpha_y == pytest.approx(2 / 24, rel=0.04)
    assert abs((found.direction - azimuth + 90) % 180 - 90) < 1.0
    assert found.anisotropic
    assert found.alpha == pytest.approx(np.sqrt((found.alpha_x**2 + found.alpha_y**2) / 2), rel=1e-9)
    # tr Q of the correlation ellipse is the same whichever way it is turned.
    assert found.alpha_of_length == pytest.approx(found.alpha, rel=0.06)


def test_an_isotropic_map_is_not_called_anisotropic():
    z = gaussian_map(n=512, step=1.0, sigma=1.0, tau=5.0, seed=7)
    assert gonio.roughness(z, spacing=1.0, **UM).anisotropic is False


def test_a_tilt_is_levelled_and_kept_on_request():
    z = gaussian_map(n=256, step=1.0, sigma=1.0, tau=5.0, seed=8)
    rows, columns = np.mgrid[:256, :256]
    tilted = z + 0.3 * columns - 0.1 * rows + 7.0
    flat = gonio.roughness(z, spacing=1.0, **UM)
    assert gonio.roughness(tilted, spacing=1.0, **UM).alpha == pytest.approx(flat.alpha, rel=1e-9)
    kept = gonio.roughness(tilted, spacing=1.0, level=False, **UM)
    assert kept.alpha == pytest.approx(np.sqrt(flat.alpha**2 + 0.3**2 + 0.1**2), rel=0.02)


def test_levelling_leaves_nothing_of_a_plane_with_holes():
    rows, columns = np.mgrid[:40, :30]
    z = 2.0 + 0.5 * rows - 0.25 * columns
    z[5:9, 3:20] = np.nan
    assert np.nanmax(np.abs(levelled(z))) < 1e-12


@pytest.mark.parametrize("cutoff", [2.0, 4.0, 80.0])
@pytest.mark.parametrize("ratio", [1.0, 2.0, 4.0])
def test_the_filter_keeps_half_of_a_sine_of_its_cutoff(cutoff, ratio):
    """Down to the shortest cutoff that is allowed, four steps."""
    x = np.arange(20_000) * 0.5
    z = np.sin(2 * np.pi * x / (cutoff * ratio))
    kept = gaussian(z, cutoff=cutoff, steps=(0.5,))[4000:16_000]
    transmission = 2 * np.mean(kept * z[4000:16_000])
    assert transmission == pytest.approx(np.exp(-np.log(2) / ratio**2), abs=2e-3)


def test_the_weighting_function_is_the_one_of_the_standard():
    # s(x) = exp(-pi (x / (a L))²) / (a L) with a = sqrt(ln 2 / pi), the form in which the standard writes it.
    a = np.sqrt(np.log(2) / np.pi)
    np.testing.assert_allclose(SIGMA_OF_CUTOFF, a / np.sqrt(2 * np.pi), rtol=1e-14)


def test_the_filter_of_a_map_bridges_holes_from_their_neighbours():
    z = np.full((60, 60), 3.0)
    z[20:25, 30:34] = np.nan
    np.testing.assert_allclose(gaussian(z, cutoff=10.0, steps=(1.0, 1.0)), 3.0, rtol=1e-12)


def test_slopes_of_a_polynomial_of_the_sixth_degree_are_exact():
    x = np.linspace(-1.0, 1.0, 41)
    p = np.polynomial.Polynomial([0.3, -1.0, 0.5, 2.0, -0.7, 0.2, 1.1])
    np.testing.assert_allclose(slope(p(x), axis=0, step=x[1] - x[0]), p.deriv()(x)[3:-3], atol=1e-12)


def test_the_slope_of_a_sine_is_its_wave_number_over_root_two():
    x = np.arange(4000) * 0.25
    z = 0.2 * np.sin(2 * np.pi * x / 20.0)
    found = gonio.roughness(z, spacing=0.25, level=False, **UM)
    assert found.rms == pytest.approx(0.2 / np.sqrt(2), rel=1e-3)
    assert found.rms_slope == pytest.approx(0.2 * 2 * np.pi / 20 / np.sqrt(2), rel=1e-3)


def test_the_bandwidth_changes_alpha_and_is_stated():
    """Behind both filters the variance is a sum of Gaussian integrals over the wave number."""
    n, tau, short, long = 200_000, 4.0, 2.0, 250.0
    rough = gaussian_profile(n=n, step=0.5, sigma=0.2, tau=tau, seed=9)
    wavy = 3.0 * np.sin(2 * np.pi * np.arange(n) * 0.5 / 2000.0)
    found = gonio.roughness(rough + wavy, spacing=0.5, lambda_s=short, lambda_c=long, **UM)
    assert (found.shortest, found.longest) == (short, long)
    width, c = tau**2 + 4 * (SIGMA_OF_CUTOFF * short) ** 2, (SIGMA_OF_CUTOFF * long) ** 2
    widths = np.array([width, width + 2 * c, width + 4 * c])
    signs = np.array([1.0, -2.0, 1.0])
    # Of a wave eight times as long as the cutoff 1 - exp(-ln 2 / 64), one per cent of the height, stays.
    wave = 3.0 * (1 - 2 ** (-1 / 64)) / np.sqrt(2)
    rms = np.sqrt(0.04 * tau * (signs / widths**0.5).sum() + wave**2)
    alpha = np.sqrt(2 * 0.04 * tau * 2 * (signs / widths**1.5).sum())
    assert abs(found.rms - rms) < 4 * found.u_rms < 0.04 * rms
    assert abs(found.alpha - alpha) < 4 * found.u_alpha < 0.04 * alpha
    assert gonio.roughness(rough + wavy, spacing=0.5, **UM).rms > 2.0


def test_alpha_behind_a_low_pass_is_that_of_the_filtered_surface():
    """A Gaussian surface behind a Gaussian filter is one of sigma² tau² / (tau² + 4 s²) and tau² + 4 s²."""
    tau, cutoff = 10.0, 30.0
    z = gaussian_profile(n=200_000, step=1.0, sigma=1.0, tau=tau, seed=10)
    found = gonio.roughness(z, spacing=1.0, lambda_s=cutoff, **UM)
    wider = np.sqrt(tau**2 + 4 * (SIGMA_OF_CUTOFF * cutoff) ** 2)
    assert found.rms == pytest.approx(np.sqrt(tau / wider), rel=0.02)
    assert found.alpha == pytest.approx(2 * np.sqrt(tau / wider) / wider, rel=0.02)


def test_the_stated_uncertainty_is_the_scatter_of_repeated_profiles():
    """300 profiles: the relative standard error of their scatter is 4.2 %, of the root mean square of u 1 %.

    20 % is more than four of them: a false alarm in 10,000 seeds.
    """
    found = [
        gonio.roughness(gaussian_profile(n=8000, step=1.0, sigma=1.0, tau=8.0, seed=k), spacing=1.0, **UM)
        for k in range(300)
    ]
    stated = np.sqrt(np.mean([f.u_alpha**2 for f in found]))
    assert stated == pytest.approx(np.std([f.alpha for f in found]), rel=0.2)
    stated = np.sqrt(np.mean([f.u_rms**2 for f in found]))
    assert stated == pytest.approx(np.std([f.rms for f in found]), rel=0.2)


def test_points_that_were_not_measured_are_left_out_and_told():
    z = gaussian_map(n=400, step=1.0, sigma=1.0, tau=6.0, seed=11)
    whole = gonio.roughness(z, spacing=1.0, **UM)
    z[np.random.default_rng(1).random(z.shape) < 0.02] = np.nan
    found = gonio.roughness(z, spacing=1.0, **UM)
    assert found.alpha == pytest.approx(whole.alpha, rel=0.02)
    assert any("not measured" in w for w in found.warnings)


def test_the_correlation_length_ignores_holes():
    z = gaussian_profile(n=50_000, step=1.0, sigma=1.0, tau=12.0, seed=12)
    z[np.random.default_rng(2).random(z.shape) < 0.3] = np.nan
    assert correlation_length(z, axis=0, step=1.0) == pytest.approx(12.0, rel=0.05)


def warnings_of(z, **options):
    return " | ".join(gonio.roughness(z, **{"spacing": 1.0, "lambda_s": 4.0, **UM, **options}).warnings)


def test_a_fine_surface_of_enough_extent_has_no_warnings():
    z = gaussian_map(n=1024, step=1.0, sigma=2.0, tau=10.0, seed=13)
    assert warnings_of(z) == ""


def test_slopes_that_the_steps_are_too_coarse_for_are_told():
    z = gaussian_map(n=512, step=1.0, sigma=1.0, tau=2.0, seed=14)
    assert "undersampled" in warnings_of(z, lambda_s=None)


def test_a_surface_smoother_than_the_wavelength_is_told_with_what_stays_specular():
    z = gaussian_map(n=1024, step=1.0, sigma=0.02, tau=10.0, seed=15)
    found = gonio.roughness(z, spacing=1.0, lambda_s=4.0, wavelength=550.0, **UM)
    assert found.coherent == pytest.approx(np.exp(-((4 * np.pi * found.rms / 0.55) ** 2)), rel=1e-12)
    assert any(f"leaves {100 * found.coherent:.2g} % of the reflected light" in w for w in found.warnings)


def test_a_surface_that_leaves_nothing_in_the_mirror_direction_is_all_facets():
    """494 nm of height are below a wavelength of 550 nm, and leave exp(-127) in the mirror direction."""
    z = gaussian_map(n=1024, step=1.0, sigma=0.494, tau=10.0, seed=15)
    found = gonio.roughness(z, spacing=1.0, lambda_s=4.0, wavelength=550.0, **UM)
    assert found.rms < 0.55
    assert found.coherent < 1e-40
    assert not any("mirror direction" in w for w in found.warnings)


def test_slopes_that_are_not_gaussian_are_told():
    z = gaussian_map(n=1024, step=1.0, sigma=1.0, tau=10.0, seed=16)
    assert "not Gaussian (excess kurtosis" in warnings_of(np.sinh(1.5 * z))


def test_an_autocorrelation_that_is_not_gaussian_is_told():
    fine = gaussian_map(n=1024, step=1.0, sigma=0.3, tau=4.0, seed=17)
    coarse = gaussian_map(n=1024, step=1.0, sigma=1.5, tau=25.0, seed=18)
    assert "depends on the bandwidth" in warnings_of(fine + coarse)


def test_blocks_shorter_than_ten_correlation_lengths_are_told():
    z = gaussian_map(n=256, step=1.0, sigma=1.0, tau=10.0, seed=19)
    assert "uncertainties are too small" in warnings_of(z)


@pytest.mark.parametrize(
    ("options", "names"),
    [
        ({"lambda_s": 0.5}, ("lambda_s", "0.5")),
        ({"lambda_c": 5000.0}, ("lambda_c", "5000")),
        ({"lambda_s": 50.0, "lambda_c": 20.0}, ("lambda_s", "less than lambda_c")),
        ({"blocks": 1}, ("blocks",)),
        ({"wavelength": -1.0}, ("wavelength",)),
        ({"spacing": 0.0}, ("spacing",)),
        ({"spacing": None}, ("spacing",)),
        ({"x_unit": "inch"}, ("x_unit", "inch")),
    ],
)
def test_what_cannot_be_is_named(options, names):
    z = gaussian_profile(n=1000, step=1.0, sigma=1.0, tau=8.0)
    with pytest.raises(gonio.GonioError) as error:
        gonio.roughness(z, **{"spacing": 1.0, **UM, **options})
    for name in names:
        assert name in str(error.value)
