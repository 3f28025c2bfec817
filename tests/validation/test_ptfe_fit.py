"""The choice between analytic models on NIST's sintered PTFE [Germer2017], a white diffuser."""

import gonio
import pytest

from .places import SHARED

FOLDER = SHARED / "nist-ptfe-mountain"


@pytest.mark.parametrize("wavelength", [351, 532, 633, 1064])
def test_the_model_of_a_white_diffuser_is_determined_and_keeps_energy(wavelength):
    files = sorted(FOLDER.glob(f"ptfe_{wavelength}nm_i*.txt"))
    if not files:
        pytest.skip(f"no NIST PTFE data in {FOLDER}")
    best = gonio.fit(gonio.process(files))
    assert all(e.open is None for e in best.estimates), best.ranking.sentence
    assert best.albedo.value <= 1.0 + 2.0 * best.albedo.u
    assert best.estimates[0].value > 0.9
    least = min(f.held_out_error for f in best.ranking.fits)
    assert best.held_out_error <= 1.1 * least
    # What has the least error there says nothing of its diffuse share.
    if wavelength == 532:
        assert list(best.ranking.passed_over) == ["harvey-shack", "abg"]
        assert "the readings leave kd, ks" in best.ranking.sentence
