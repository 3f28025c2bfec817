"""Where the real measurements are."""

import os
from pathlib import Path

ROOT = Path(__file__).parents[2]
SHARED = Path(os.environ.get("GONIO_SHARED_DATA", ROOT.parent / "shared" / "data"))
