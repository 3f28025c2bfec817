"""`python -m bench [ids…]`: run benchmarks, print a table, merge the records into bench/results.json.

A record is {id, ours, peer, peer_name, ratio, unit, command}; `ratio` is peer / ours. A module may carry
`IDS`, the ids its `run` gives, so that only the modules that are asked for run.
"""

from __future__ import annotations

import importlib
import json
import pkgutil
import sys
from pathlib import Path
from typing import Any

import bench

RESULTS = Path(__file__).with_name("results.json")


def main(wanted: list[str]) -> int:
    known: dict[str, dict[str, Any]] = {}
    if RESULTS.exists():
        known = {r["id"]: r for r in json.loads(RESULTS.read_text())}
    done: set[str] = set()
    for info in sorted(pkgutil.iter_modules(bench.__path__), key=lambda m: m.name):
        if info.name.startswith("_"):
            continue
        module = importlib.import_module(f"bench.{info.name}")
        ids = getattr(module, "IDS", None)
        if not hasattr(module, "run") or (wanted and ids is not None and not set(wanted) & set(ids)):
            continue
        for record in module.run():
            if wanted and record["id"] not in wanted:
                continue
            known[record["id"]] = record
            done.add(record["id"])
            print(
                f"{record['id']:32} {record['ours']:10.4g} {record['peer']:10.4g} {record['unit']:8}"
                f" {record['ratio']:8.2f} x {record['peer_name']}",
                flush=True,
            )
    missing = [name for name in wanted if name not in done]
    if missing:
        print(f"no benchmark gives {', '.join(missing)}", file=sys.stderr)
        return 2
    partial = RESULTS.with_suffix(".json.part")
    partial.write_text(json.dumps(sorted(known.values(), key=lambda r: r["id"]), indent=1) + "\n")
    partial.replace(RESULTS)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
