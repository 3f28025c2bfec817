"""The rooms of the project: who may use whom."""

import ast
import json
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

# crate -> crates it may use, everything left of it in the chain included (docs/architecture.md)
ALLOWED = {
    "geom": set(),
    "bsdf": {"geom"},
    "scan": {"geom", "bsdf"},
    "fit": {"geom", "bsdf", "scan"},
    "build": {"geom", "bsdf", "scan", "fit"},
    "io": {"geom", "bsdf", "scan"},
    "trace": {"geom", "bsdf"},
    "scene": {"geom", "bsdf", "trace", "io", "scan"},
    "instrument": {"geom", "bsdf", "scan", "trace", "scene", "io"},
}


@pytest.fixture(scope="module")
def edges() -> dict[str, set[str]]:
    command = ["cargo", "metadata", "--no-deps", "--format-version", "1", "--offline"]
    text = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return {
        package["name"].removeprefix("gonio-"): {
            d["name"].removeprefix("gonio-")
            for d in package["dependencies"]
            if d["name"].startswith("gonio-")
        }
        for package in json.loads(text)["packages"]
    }


def test_crates_use_only_what_stands_left_of_them(edges):
    forbidden = {
        (crate, used) for crate, uses in edges.items() if crate != "py" for used in uses - ALLOWED[crate]
    }
    assert not forbidden


def test_only_the_binding_crate_knows_python(edges):
    manifests = [m for m in ROOT.glob("crates/*/Cargo.toml") if "pyo3" in m.read_text()]
    assert [m.parent.name for m in manifests] == ["py"]
    assert all("py" not in uses for uses in edges.values())


def imports(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add(node.module or "")
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def test_the_command_line_calls_the_public_api_and_never_the_native_module():
    files = sorted((ROOT / "python" / "gonio" / "cli").rglob("*.py"))
    assert files
    offenders = [f.name for f in files if any("_native" in name for name in imports(f))]
    assert not offenders


def test_nothing_outside_the_cli_imports_it():
    package = ROOT / "python" / "gonio"
    files = [f for f in package.rglob("*.py") if not {"cli", "__main__.py"} & {*f.relative_to(package).parts}]
    assert not [f.name for f in files if any(name.startswith("gonio.cli") for name in imports(f))]
