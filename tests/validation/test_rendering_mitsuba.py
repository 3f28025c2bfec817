"""Pictures of the same scenes by gonio and Mitsuba 3, patch by patch.

Seeds are fixed. Where both follow the same light, a scene fails one of its five criteria by chance in about
10 of 10 000 runs (four deviations each, Student's t with some 30 degrees of freedom for the two means, p
below 1e-4 for the distribution). gonio's pixels share paths in tiles, so that their mean is judged by its
scatter from seed to seed.
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


def test_the_difference_of_a_patch_over_its_error_is_standard_normal(both):
    found = agreement(*both)
    n = len(found.z)
    assert n > 300
    assert abs(found.mean_z) < 4.0
    assert abs(found.even_z) < 4.0
    assert abs(found.z.var() - 1.0) < 4.0 * np.sqrt(2.0 / n)
    assert found.beyond_3 < 0.0027 + 4.0 * np.sqrt(0.0027 / n)
    assert found.kolmogorov > 1e-4


def test_two_per_cent_of_the_light_are_noticed(both):
    ours, theirs = both
    found = agreement(1.02 * ours, theirs)
    assert abs(found.mean_z) > 4.0
    assert found.kolmogorov < 1e-4
