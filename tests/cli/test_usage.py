"""The command itself: usage, help, interruption."""

import pytest

from tests.cli.conftest import one_clear_error


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (["process", "a.txt"], ["--out", "gonio process --help"]),
        (["process", "-o", "m"], ["Missing argument", "gonio process --help"]),
        (["process", "a.txt", "-o", "m", "--u-angle", "wide"], ["--u-angle", "number"]),
        (["check", "m", "--magic"], ["--magic", "gonio check --help"]),
        (["simulate", "-o", "m", "--component", "sideways"], ["--component", "sideways", "transmission"]),
        (["bake"], ["bake", "gonio --help"]),
    ],
)
def test_a_usage_error_is_one_line_that_names_the_help(run, arguments, names):
    one_clear_error(run(*arguments), *names)


@pytest.mark.parametrize("arguments", [[], ["--help"]])
def test_without_arguments_the_verbs_are_listed(run, arguments):
    done = run(*arguments)
    assert done.code == 0
    for verb in (
        "inspect",
        "process",
        "check",
        "build",
        "reduce",
        "compare",
        "export",
        "report",
        "render",
        "simulate",
        "specularity",
        "roughness",
        "surface",
        "colour",
        "demo",
    ):
        assert verb in done.out


def test_an_interruption_outside_the_verbs_is_told(run, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("typer.main.get_params_from_function", interrupted)
    done = run("simulate", "-o", "camp")
    assert (done.code, done.err.strip()) == (130, "gonio: interrupted, nothing was written")
