"""`python -m tests.validation [page…]`: regenerate the pages of docs/validation from data and programs.

A page whose data or programs are missing is left as it is, and said to be; the exit code is 1 only for a page
that could be made and failed.
"""

from __future__ import annotations

import importlib
import sys
import time
import traceback

from .pages import Skipped
from .places import ROOT

PAGES = (
    "weights",
    "nist-ptfe",
    "data-driven",
    "radiance-xml",
    "radiance-materials",
    "rendering-radiance",
    "samplers",
    "mutants",
    "export",
    "compact",
    "other-instruments",
    "microfacet",
    "cie171",
    "rendering-mitsuba",
    "rendering-errors",
    "fit-recovery",
    "fit-real-data",
    "loop-closure",
    "planner",
    "sphere",
)


def main(wanted: list[str]) -> int:
    unknown = set(wanted) - set(PAGES)
    if unknown:
        print(f"no page {', '.join(sorted(unknown))}; there are {', '.join(PAGES)}", file=sys.stderr)
        return 2
    failed = 0
    for name in wanted or PAGES:
        page = ROOT / "docs" / "validation" / f"{name}.md"
        start = time.perf_counter()
        try:
            module = importlib.import_module(f".pages.{name.replace('-', '_')}", __package__)
            text = module.make()
        except Skipped as reason:
            print(f"{name}: skipped, {reason}")
            continue
        except Exception:
            traceback.print_exc()
            print(f"{name}: failed", file=sys.stderr)
            failed = 1
            continue
        partial = page.with_suffix(".md.part")
        partial.write_text(text.rstrip() + "\n", encoding="utf-8")
        partial.replace(page)
        print(f"{name}: {page.relative_to(ROOT)}, {time.perf_counter() - start:.0f} s", flush=True)
    return failed


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
