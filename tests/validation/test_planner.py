"""Planned paths against uniform ones, and the rule for patches (docs/validation/planner.md)."""

import numpy as np
import pytest
from gonio import _native

from .patch_rule import patch_errors, rms
from .planning import (
    CASES,
    Reached,
    compared,
    instrument,
    material,
    measure,
    needed,
    planned,
    reached,
    true_peak,
    uniform,
)

ON_THE_PAGE = ("Ward-GMD, alpha .05", "Ward-GMD, alpha .1")
"""Between the others; docs/validation/planner.md has all of them at three incidences."""


@pytest.mark.parametrize(
    ("name", "theta_i"), [("Ward-GMD, alpha .1", 45.0), ("brushed, alpha .04, .3", 10.0)]
)
def test_a_plan_is_better_than_three_times_its_readings_evenly_spread(name, theta_i):
    model, it, incidence = material(name), instrument(), (theta_i, 0.0)
    truth = _albedo(model, theta_i)
    top = true_peak(model, dict(it.settings), *incidence)
    plan = reached(planned(model, it, incidence, seeds=3, dhr=0.005, peak=0.01), truth, top)
    rows = []
    for seed in range(3):
        pitch = np.degrees(np.sqrt(2 * np.pi / (3.0 * plan.readings)))
        line = (incidence, uniform(pitch, it.settings["theta_max"], np.random.default_rng(seed)))
        rows += measure(model, it, [line], seed=seed)
    even = reached(rows, truth, top)
    assert even.readings > 2.7 * plan.readings
    # What was asked, by claim and by error.
    assert plan.dhr_claim <= 0.006
    assert plan.dhr_error <= 0.006
    assert plan.peak_error <= 0.015
    assert not even.within(plan, claims=False), (plan, even)
    assert not even.within(plan, claims=True), (plan, even)


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in CASES if name not in ON_THE_PAGE])
def test_every_glossy_material_takes_a_third_of_the_readings_of_a_uniform_path(name):
    plan, ladder = compared(name, 60.0, seeds=3, dhr=0.005, peak=0.01)
    for claims in (False, True):
        assert min(needed(plan, ladder, claims=claims), ladder[-1].readings) > 3.0 * plan.readings


def test_needed_is_the_coarsest_from_which_on_all_are_as_good():
    goal = Reached(10, 0.1, 0.1, 0.1, 0.1)
    good, bad = Reached(0, 0.05, 0.05, 0.05, 0.05), Reached(0, 0.2, 0.05, 0.05, 0.05)
    ladder = [good, bad, Reached(30, 0.1, 0.0, 0.0, 0.0), good]
    assert needed(goal, ladder, claims=False) == 30
    assert needed(goal, [good, bad], claims=False) == np.inf
    assert needed(goal, [bad], claims=True) == 0


def test_a_patch_ends_two_and_a_half_widths_from_the_top_or_costs_the_dhr():
    short, _ = patch_errors(radius=1.5, pitch=0.25, growth=0.0)
    enough, _ = patch_errors(radius=2.5, pitch=0.25, growth=0.0)
    assert rms(enough) < 0.004
    assert rms(short) > 8.0 * rms(enough)


def _albedo(model, theta_i):

    return _native.directional_albedo(model, theta_i=theta_i, phi_i=0.0, component="reflection")
