"""What the validation tests need: RADIANCE and the real measurements."""

import pytest

from .places import SHARED
from .radiance import Radiance


@pytest.fixture(scope="session")
def radiance():
    package = pytest.importorskip("pyradiance", reason="pyradiance has no wheel for this platform")
    return Radiance(package)


@pytest.fixture(scope="session")
def shared():
    """Folder of real measurements."""
    if not SHARED.is_dir():
        pytest.skip("the real measurements are not on this machine")
    return SHARED
