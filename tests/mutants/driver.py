"""Puts each mistake into a copy of the crate and runs its tests."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from .edits import MUTANTS, Mutant

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "crates" / "bsdf" / "src"
# A stage runs only for what those before it cannot see: samplers, the other laws, closed forms and examples.
STAGES = (
    ("--test", "statistical"),
    ("--test", "property"),
    (
        *("--test", "lobes"),
        *("--test", "albedo"),
        *("--test", "analytic"),
        *("--test", "microfacet"),
        *("--test", "furnace"),
    ),
    ("--lib",),
)
FAILED = re.compile(r"^test (\S+) \.\.\. FAILED$|^(\S+) --- FAILED$", re.MULTILINE)

VERSIONS = re.compile(r"^#\[multiversion\(targets\(.*\)\)\]\n", re.MULTILINE)


class Broken(Exception):
    """The check itself cannot be trusted."""


@dataclass(frozen=True)
class Outcome:
    """What became of a mutant: the tests that noticed it."""

    mutant: Mutant
    noticed_by: tuple[str, ...]


class Copy:
    """A copy of the workspace with the crates that the scattering models need."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in ("Cargo.toml", "Cargo.lock", "clippy.toml"):
            if (ROOT / name).is_file():
                shutil.copy(ROOT / name, folder / name)
        # A test reads the pages of the models. Files are dated anew: cargo must not take what it built of an
        # earlier copy.
        for name in ("crates/geom", "crates/bsdf", "docs/models"):
            shutil.copytree(ROOT / name, folder / name, copy_function=shutil.copy)
        # One version of each loop, for any processor, compiles in a third of the time.
        for path in (folder / "crates/bsdf/src").rglob("*.rs"):
            text = path.read_text(encoding="utf-8")
            path.write_text(VERSIONS.sub("", text), encoding="utf-8")
        target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "mutants"
        self.environment = {
            **os.environ,
            "CARGO_TARGET_DIR": str(target),
            "CARGO_PROFILE_DEV_DEBUG": "none",
            "RUST_BACKTRACE": "0",
        }

    def failures(self, stage: tuple[str, ...], models: Iterable[str], samples: int) -> tuple[str, ...]:
        """The tests of `stage` that fail; `Broken` when the copy does not compile."""
        environment = {
            **self.environment,
            "GONIO_MODELS": ",".join(models),
            "GONIO_SAMPLES": str(samples),
        }
        command = ["cargo", "test", "-p", "gonio-bsdf", *stage]
        built = subprocess.run(
            [*command, "--no-run"],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        if built.returncode != 0:
            raise Broken(f"does not compile:\n{built.stderr[-3000:]}")
        run = subprocess.run(
            [*command, "--no-fail-fast"],
            cwd=self.folder,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        found = tuple(sorted({a or b for a, b in FAILED.findall(run.stdout)}))
        if run.returncode != 0 and not found:
            raise Broken(f"the tests did not finish:\n{(run.stdout + run.stderr)[-3000:]}")
        return found

    def try_mutant(self, mutant: Mutant) -> Outcome:
        """Runs the tests with `mutant` in place and takes it out again."""
        path = self.folder / SOURCES.relative_to(ROOT) / mutant.file
        sound = path.read_text(encoding="utf-8")
        if sound.count(mutant.old) != 1:
            raise Broken(f"{mutant.file} has {mutant.old!r} {sound.count(mutant.old)} times, not once")
        path.write_text(sound.replace(mutant.old, mutant.new), encoding="utf-8")
        try:
            for stage in STAGES[mutant.first :]:
                if found := self.failures(stage, mutant.models, mutant.samples):
                    return Outcome(mutant, found)
            return Outcome(mutant, ())
        except Broken as e:
            raise Broken(f"{mutant.mistake}: {e}") from e
        finally:
            path.write_text(sound, encoding="utf-8")


def check(mutants: Iterable[Mutant] = MUTANTS) -> list[Outcome]:
    """The fate of each mutant; `Broken` when a test fails without a mistake or a mistake does not fit."""
    mutants = list(mutants)
    with tempfile.TemporaryDirectory(prefix="gonio-mutants-") as folder:
        copy = Copy(Path(folder))
        for samples in sorted({m.samples for m in mutants}):
            models = sorted({name for m in mutants if m.samples == samples for name in m.models})
            for stage in STAGES:
                if found := copy.failures(stage, models, samples):
                    raise Broken(f"fails without a mistake: {', '.join(found)}")
        return [copy.try_mutant(m) for m in mutants]
