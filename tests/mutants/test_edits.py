import pytest

from tests.mutants.driver import SOURCES
from tests.mutants.edits import MUTANTS


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda m: m.mistake)
def test_a_mistake_fits_the_source_once(mutant):
    assert (SOURCES / mutant.file).read_text(encoding="utf-8").count(mutant.old) == 1
    assert mutant.old != mutant.new
