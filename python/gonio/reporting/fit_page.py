"""The page of a fit: parameters, ranking, and where the model departs from the readings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

from gonio._drawing.numbers import angle, number, percent
from gonio._drawing.shapes import Snapshot, snapshot
from gonio._native import DomainError
from gonio.files import replacing_file
from gonio.fit_parameters import Estimate
from gonio.fit_results import Fit, SliceResidual
from gonio.measurement import Measurement
from gonio.measurement_header import JSON_NAME
from gonio.reporting import fit_figures, provenance
from gonio.reporting.header import grouped
from gonio.reporting.page import environment, static
from gonio.reporting.wording import channel_label, in_symbols

MOST_FIGURES = 24
"""Slices that are drawn; of more, the worst of each incidence and then the worst of all."""


def render_fit(
    fit: Fit,
    measurement: Measurement,
    *,
    out: Path,
    losses: Mapping[str, Sequence[str]] | None = None,
    refused: Mapping[str, str] | None = None,
) -> Path:
    """Write the page of a fit as one HTML file that needs nothing else, not even a network or scripts.

    `losses` and `refused` tell, by file, what materials of other programs do not hold and why there are none.

    Raises
    ------
    DomainError
        The predictions do not belong to the measurement.
    OSError
        `out` cannot be written; nothing is left behind.
    """
    slices = [snapshot(s) for s in measurement.slices]
    if [len(s.dsf) for s in slices] != [len(p) for p in fit.predicted]:
        raise DomainError(
            f"measurement: found {sum(len(s.dsf) for s in slices)} readings in {len(slices)} slices, allowed "
            f"those of the fit: {sum(len(p) for p in fit.predicted)} in {len(fit.predicted)}"
        )
    drawn = _drawn(fit, slices)
    residuals = [fit_figures.relative_residuals(slices[k], fit.predicted[k]) for k in drawn]
    limit = fit_figures.limit_of(residuals)
    pictures = [
        {
            "caption": fit_figures.caption(slices[k]),
            "png": fit_figures.slice_figure(slices[k], fit.predicted[k], limit=limit),
        }
        for k in drawn
    ]
    taking_part = {r.slice for r in fit.residuals}
    ranking = None if fit.ranking is None else fit.ranking.to_dict()
    fwhm = measurement.signature_fwhm
    facts = [
        ("Model", fit.title if fit.title == fit.model else f"{fit.model}: {fit.title}"),
        ("Readings", grouped(fit.readings)),
        ("Incidences", str(len({(round(r.theta_i, 4), round(r.phi_i, 4)) for r in fit.residuals}))),
        ("Metric", f"{fit.metric}, {fit.loss}" if fit.metric == "chi2" else fit.metric),
        ("Residuals over stated noise", f"{number(fit.noise_ratio, 3)} ×"),
        ("Left-out incidences", percent(fit.held_out_error) if fit.held_out_error is not None else None),
        ("Resolution", f"{number(fwhm, 3)}° beam FWHM" if fwhm else "beam not measured"),
    ]
    page = (
        environment()
        .get_template("fit.html.j2")
        .render(
            title=measurement.sample_name or _file_name(fit) or "unnamed sample",
            sentence=_symbols(ranking["sentence"] if ranking else _sentence(fit)).replace("+", "+\u200b"),
            status="warn" if fit.warnings or not fit.converged else "pass",
            facts=[(label, value) for label, value in facts if value],
            warnings=[_symbols(w.text) for w in fit.warnings],
            estimates=[_estimate(e) for e in fit.estimates],
            correlations=[
                (channel_label(c.first), channel_label(c.second), f"{c.value:+.2f}".replace("-", "−"))
                for c in fit.notable_correlations
            ],
            models=[_ranked(row) for row in ranking["models"]] if ranking else [],
            failed={k: _symbols(v) for k, v in ranking["failed"].items()} if ranking else {},
            errors=fit_figures.errors_figure(fit.ranking.fits if fit.ranking else [fit]),
            residuals=[_residual(r) for r in fit.residuals],
            several_channels=len({r.channel for r in fit.residuals}) > 1,
            several_components=len({r.component for r in fit.residuals}) > 1,
            several_phi=len({round(r.phi_i, 3) for r in fit.residuals if r.theta_i > 0.01}) > 1,
            pictures=pictures,
            all_slices=len(taking_part),
            limit=percent(limit, 0),
            losses={k: [_symbols(t) for t in v] for k, v in (losses or {}).items()},
            refused={k: _symbols(v) for k, v in (refused or {}).items()},
            provenance=provenance.sections(fit.provenance),
            version=metadata.version("gonio"),
            style=static("style.css"),
        )
    )
    with replacing_file(out) as temporary:
        temporary.write_text(page, encoding="utf-8", newline="\n")
    return out


def _file_name(fit: Fit) -> str | None:
    """Name of the file or directory that was fitted."""
    for given in fit.provenance.get("inputs", ()):
        if given.get("role") == "measurement" and "path" in given:
            path = Path(given["path"])
            return path.resolve().parent.name if path.name == JSON_NAME else path.stem
    return None


def _drawn(fit: Fit, slices: Sequence[Snapshot]) -> list[int]:
    """Slices to draw, by incidence: all that took part, or the worst when they are too many."""
    error: dict[int, float] = {}
    for r in fit.residuals:
        error[r.slice] = max(error.get(r.slice, 0.0), r.relative_l1)
    chosen = sorted(error, key=lambda k: -error[k])
    if len(chosen) > MOST_FIGURES:
        first: dict[tuple[float, float], int] = {}
        for k in chosen:
            first.setdefault((round(slices[k].theta_i, 4), round(slices[k].phi_i, 4)), k)
        leading = list(first.values())
        chosen = (leading + [k for k in chosen if k not in set(leading)])[:MOST_FIGURES]
    return sorted(chosen, key=lambda k: (slices[k].phi_i, slices[k].theta_i, k))


def _sentence(fit: Fit) -> str:
    if fit.held_out_error is None:
        return f"{fit.model} was fitted; nothing was left out to test it on."
    worst = max(fit.held_out, key=lambda h: h.relative_l1)
    return (
        f"{fit.model} predicts incidences that it was not fitted to with an error of "
        f"{100 * fit.held_out_error:.1f} % (relative L1), worst at theta_i = {worst.theta_i:.1f} deg "
        f"({100 * worst.relative_l1:.1f} %)."
    )


def _symbols(text: str) -> str:
    return (
        in_symbols(text)
        .replace("theta_i = ", "θi\u00a0=\u00a0")
        .replace("theta_i", "θi")
        .replace("theta_s", "θs")
    )


def _estimate(e: Estimate) -> dict[str, str]:
    unit = "" if e.unit == "1" else " °" if e.unit == "degree" else f" {e.unit}"
    value, interval = number(e.value, 5) + unit, f"{number(e.low, 5)} … {number(e.high, 5)}"
    u, u_model = number(e.u, 2), number(e.u_model, 2)
    if e.kind == "fixed":
        interval = u = u_model = "—"
    elif e.kind == "upper_limit":
        value, interval, u, u_model = f"< {number(e.high, 3)}{unit}", f"0 … {number(e.high, 3)}", "—", "—"
    elif e.kind == "undetermined":
        value = interval = u = u_model = "—"
    kinds = {"value": e.interval, "upper_limit": "upper limit"}
    return {
        "name": e.name,
        "channel": "" if e.channel is None else channel_label(e.channel),
        "value": value,
        "u": u,
        "interval": interval,
        "u_model": u_model,
        "kind": kinds.get(e.kind, e.kind),
        "meaning": e.meaning,
    }


def _ranked(row: Mapping[str, Any]) -> dict[str, str]:
    worst = row["worst_error"]
    return {
        "model": row["model"].replace("+", "+\u200b"),
        "title": "" if row["title"] == row["model"] else row["title"],
        "error": "—" if row["held_out_error"] is None else percent(row["held_out_error"]),
        "worst": "—" if worst is None else f"{percent(worst)} at θi {angle(row['worst_theta_i'])}°",
        "aicc": "—" if row["delta_aicc"] is None else f"{row['delta_aicc']:+.1f}".replace("-", "−"),
        "parameters": str(row["parameters"]),
        "programs": ", ".join(row["materials"]) or "—",
        "warnings": ", ".join(dict.fromkeys(w["code"].replace("_", " ") for w in row["warnings"])),
    }


def _residual(r: SliceResidual) -> dict[str, str]:
    return {
        "theta_i": angle(r.theta_i),
        "phi_i": angle(r.phi_i),
        "channel": channel_label(r.channel),
        "component": r.component,
        "readings": grouped(r.readings),
        "l1": percent(r.relative_l1),
        "bias": percent(r.bias, sign=True),
        "peak": number(r.peak_ratio, 3),
        "chi2": number(r.chi2, 3),
    }
