"""Microfacet models against Mitsuba 3."""

import numpy as np
import pytest

from .mitsuba import MODELS, Mitsuba, compare, random_cases, rational_error

# Single precision in Mitsuba leaves up to 3e-5, and 1e-4 where a conductor of index near 1 hardly reflects.
TOLERANCE = 1e-4


@pytest.fixture(scope="module")
def mitsuba():
    package = pytest.importorskip("mitsuba", reason="mitsuba has no wheel for this platform")
    return Mitsuba(package)


@pytest.mark.parametrize("model", MODELS)
def test_values_and_densities_agree_with_mitsuba(mitsuba, model):
    cases = random_cases(model, 1000, seed=sum(map(ord, model)))
    found = [compare(case, mitsuba(case)) for case in cases]
    values = np.array([c.value for c in found])
    densities = np.array([c.pdf for c in found])
    worst = int(np.abs(values - 1.0).argmax())
    assert np.abs(values - 1.0).max() < TOLERANCE, (values[worst], cases[worst])
    worst = int(np.abs(densities - 1.0).argmax())
    assert np.abs(densities - 1.0).max() < TOLERANCE, (densities[worst], cases[worst])


def test_the_rational_masking_that_is_taken_out_is_as_good_as_its_paper_says():
    assert 0.003 < rational_error() < 0.0036
