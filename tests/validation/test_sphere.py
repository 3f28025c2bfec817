"""The simulated DIN 5036-3 procedure and the sphere multiplier."""

import pytest

from .sphere import CASES, Case, multipliers


@pytest.mark.parametrize("case", [CASES[k] for k in (1, 3, 5, 7)], ids=str)
def test_the_procedure_gives_the_specularity_of_a_plastic_within_two_percent(case: Case):
    m = case.measured(2**18)
    assert m.port.u_rays < 0.008 * m.model_port
    assert abs(m.port.value / m.model_port - 1.0) < 0.02
    share = m.diffuse_share
    wanted = (m.model_port - share * m.model_total) / (1.0 - share)
    assert abs(m.specularity.value / wanted - 1.0) < 0.02
    assert abs(m.total.value / m.model_total - 1.0) < 0.01


def test_the_multiplier_agrees_with_its_formula_within_half_a_percent():
    found = multipliers(2**16)
    assert len(found) == 24
    assert max(m.u / m.formula for m in found) < 2.5e-3
    assert max(abs(m.off) for m in found) < 5e-3
