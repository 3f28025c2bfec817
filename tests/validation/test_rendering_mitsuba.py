"""Pictures of the same scenes by gonio and Mitsuba 3, pixel by pixel.

Seeds are fixed. Where both follow the same light, a scene fails one of its five criteria by chance in about
4 of 10 000 runs (four deviations each, p below 1e-4 for the distribution). gonio's pixels share paths
in tiles, but most of the noise is Mitsuba's, whose pixels are independent.
"""

import numpy as np
import pytest

from .mitsuba_pictures import TWINS, agreement, pictures, ready


@pytest.fixture(scope="module")
def mitsuba():
    pytest.importorskip("mitsuba", reason="mitsuba has no wheel for this platform")
    package = ready()
    if package is None:
        pytest.skip("Mitsuba needs LLVM from 19 on (DRJIT_LIBLLVM_PATH)")
    yield package
    package.set_variant("scalar_rgb")


@pytest.fixture(scope="module", params=TWINS, ids=lambda t: t.name)
def both(request, mitsuba):
    return pictures(mitsuba, request.param, size=40, samples=64, runs=16)


def test_the_difference_of_a_pixel_over_its_error_is_standard_normal(both):
    found = agreement(*both)
    n = len(found.z)
    assert n > 1000
    assert abs(found.mean_z) < 4.0
    assert abs(found.z.mean()) < 4.0 / np.sqrt(n)
    assert abs(found.z.var() - 1.0) < 4.0 * np.sqrt(2.0 / n)
    assert found.beyond_3 < 0.0027 + 4.0 * np.sqrt(0.0027 / n)
    assert found.kolmogorov > 1e-4


def test_two_per_cent_of_the_light_are_noticed(both):
    ours, theirs = both
    found = agreement(1.02 * ours, theirs)
    assert abs(found.mean_z) > 4.0
    assert found.kolmogorov < 1e-4
