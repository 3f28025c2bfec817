"""Every source a docstring or a page names stands in docs/references.bib, once."""

import re
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
KEY = re.compile(r"\[([A-Z][A-Za-z]+\d{4}[a-z]?|ASTM[A-Z]\d+|JCGM\d+|jcgm\d+|[a-z]+\d{4}[a-z]?)[\],\\ ]")
SOURCES = sorted(
    path
    for folder, pattern in (("crates", "*.rs"), ("python", "*.py"), ("docs", "*.md"))
    for path in (ROOT / folder).rglob(pattern)
)


def bibliography() -> list[str]:
    return re.findall(r"^@\w+\{([^,\s]+)", (ROOT / "docs/references.bib").read_text(), re.MULTILINE)


def test_a_key_stands_once_in_the_bibliography():
    twice = [key for key, n in Counter(key.lower() for key in bibliography()).items() if n > 1]
    assert twice == []


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_cited_keys_are_in_the_bibliography(path):
    missing = sorted(set(KEY.findall(path.read_text(encoding="utf-8"))) - set(bibliography()))
    assert missing == []
