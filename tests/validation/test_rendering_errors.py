"""Stated standard errors against true ones, and the mean of pictures that stop by their error.

The limits are the measured coverage of docs/validation/rendering-errors.md and four standard deviations of a
share of the values that are counted; seeds are fixed.
"""

import pytest

from . import rendering_errors as errors


@pytest.fixture(scope="module")
def truth():
    return errors.cornell_truth(2048)


@pytest.mark.parametrize("samples", [64, 256])
def test_where_light_is_reflected_stated_errors_are_true_to_a_tenth(truth, samples):
    found = errors.coverage(*errors.cornell(samples, range(1, 17)), truth, samples)
    assert 0.66 < found.within_68 < 0.75
    assert 0.94 < found.within_95 < 0.98
    assert 0.98 < found.ratio < 1.15


@pytest.mark.parametrize("case", [errors.lamp, errors.window])
def test_of_light_straight_from_lamp_and_window_stated_errors_are_too_large(case):
    found = errors.coverage(*case(256, range(1, 33)), 256)
    assert found.within_95 > 0.95
    assert 1.2 < found.ratio < 2.5


def test_an_error_that_is_stated_too_small_is_noticed(truth):
    found, stated = errors.cornell(256, range(1, 17))
    half = errors.coverage(found, 0.5 * stated, truth, 256)
    assert half.within_68 < 0.5
    assert half.within_95 < 0.8


def test_the_bias_of_stopping_by_the_error_is_below_a_fiftieth_of_it(truth):
    bias, error, paths = errors.stopping_bias(0.2, range(1, 33), truth)
    assert 64 < paths < 200
    # Four standard errors, of the truth's too: a false alarm in 16 000.
    assert abs(bias) < 0.004 + 4.0 * error
    assert error < 0.002
