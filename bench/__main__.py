"""`python -m bench [ids…]`: run benchmarks, print a table, merge the records into bench/results.json.

An id that is the name of a group stands for all whose ids begin as its members do.

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
GROUPS = {"models": ("heldout-", "build-", "ttree-", "tree-", "klems-", "compact-")}


def named(wanted: list[str], ids: set[str]) -> list[str]:
    """`wanted` with the members of groups, known by the beginning of their ids, in place of the groups."""
    out: list[str] = []
    for name in wanted:
        members = sorted(i for i in ids if i.startswith(GROUPS[name])) if name in GROUPS else [name]
        out.extend(members)
    return out


def save(known: dict[str, dict[str, Any]]) -> None:
    """Write the records, whole or not at all."""
    partial = RESULTS.with_suffix(".json.part")
    partial.write_text(json.dumps(sorted(known.values(), key=lambda r: r["id"]), indent=1) + "\n")
    partial.replace(RESULTS)


def main(asked: list[str]) -> int:
    known: dict[str, dict[str, Any]] = {}
    if RESULTS.exists():
        known = {r["id"]: r for r in json.loads(RESULTS.read_text())}
    names = sorted(m.name for m in pkgutil.iter_modules(bench.__path__) if not m.name.startswith("_"))
    modules = [m for m in (importlib.import_module(f"bench.{name}") for name in names) if hasattr(m, "run")]
    wanted = named(asked, {i for m in modules for i in getattr(m, "IDS", ())})
    done: set[str] = set()
    for module in modules:
        ids = getattr(module, "IDS", None)
        if wanted and ids is not None and not set(wanted) & set(ids):
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
        save(known)
    # Members of a group may have no peer on this machine, which they say themselves.
    missing = [name for name in asked if name not in done and name not in GROUPS]
    if missing:
        print(f"no benchmark gives {', '.join(missing)}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
