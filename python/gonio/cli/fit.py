"""`gonio fit`: parameters of an analytic model, and which model the data support."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gonio
from gonio.cli.running import Force, Json, out, pairs, print_json, progress_bar, warn
from gonio.colours import ILLUMINANTS
from gonio.fit_colour import check_tint
from gonio.fit_outputs import save_fit
from gonio.fitting import LOSSES, METRICS, WEIGHTS

SHOWN = 12
"""Models of a ranking that are printed."""


def fit(
    measurement: Annotated[
        Path | None,
        typer.Argument(
            help="Directory written by gonio process, or a measured material (RGL .bsdf); none with --sphere "
            "alone."
        ),
    ] = None,
    model: Annotated[
        str,
        typer.Option(
            help="plastic, metal, trans, ward-gmd, abg, …, a sum such as lambert+ward-gmd+ward-gmd, or auto: "
            "compare all that suit the data. A wrong name lists them."
        ),
    ] = "auto",
    models: Annotated[
        list[str] | None, typer.Option("--compare", help="A model that auto compares, not all; repeat it.")
    ] = None,
    to: Annotated[
        Path | None,
        typer.Option(
            "-o", "--out", help="Directory for fit.json, material.rad, mitsuba.xml, residuals.html."
        ),
    ] = None,
    fix: Annotated[
        list[str] | None,
        typer.Option("--fix", metavar="NAME=VALUE", help="Hold a parameter at a value; repeat it."),
    ] = None,
    channel: Annotated[
        list[str] | None, typer.Option("--channel", help="A channel to fit; repeat it. All without it.")
    ] = None,
    component: Annotated[
        str | None, typer.Option("--component", help="reflection or transmission. Both without it.")
    ] = None,
    metric: Annotated[str, typer.Option("--metric", help=f"{', '.join(METRICS)}.")] = "chi2",
    loss: Annotated[str, typer.Option("--loss", help=f"{', '.join(LOSSES)}; of chi2.")] = "soft-l1",
    weights: Annotated[str, typer.Option("--weights", help=f"{', '.join(WEIGHTS)}; of chi2.")] = "predicted",
    by_solid_angle: Annotated[
        bool, typer.Option("--by-solid-angle", help="Weigh chi2 by solid angle, too.")
    ] = False,
    max_theta_s: Annotated[
        float,
        typer.Option("--max-theta-s", help="Largest receiver angle from the normal of its side, degrees."),
    ] = 85.0,
    retro_radius: Annotated[
        float, typer.Option("--retro-radius", help="Leave out readings this close to the incidence, degrees.")
    ] = 0.0,
    signature: Annotated[
        bool, typer.Option("--signature/--no-signature", help="Fold the beam profile into the model.")
    ] = True,
    u_relative: Annotated[
        float | None,
        typer.Option(
            "--u-relative",
            help="Relative standard uncertainty of values of a measured material (.bsdf); 0.01 without it.",
        ),
    ] = None,
    u_floor: Annotated[
        float | None,
        typer.Option(
            "--u-floor", help="The same at a DSF of 0, 1/sr; 0.0002 without it. Both add in squares."
        ),
    ] = None,
    sphere: Annotated[
        Path | None,
        typer.Option(
            "--sphere", help="Readings of an integrating sphere (TOML) that count as data as well, or alone."
        ),
    ] = None,
    colour: Annotated[
        str | None,
        typer.Option(metavar="R,G,B", help="Colour at any scale for the materials of a fit of one channel."),
    ] = None,
    colour_from: Annotated[
        Path | None,
        typer.Option(
            "--colour-from", help="The same from the first spectrum of a text file (its second column)."
        ),
    ] = None,
    illuminant: Annotated[str, typer.Option(help=f"{', '.join(ILLUMINANTS)}.")] = "D65",
    as_visible: Annotated[
        bool,
        typer.Option(
            "--as-visible",
            help="Take the one channel of the fit, such as 650nm, for the visible: grey materials.",
        ),
    ] = False,
    name: Annotated[str | None, typer.Option(help="Name of the material in the written files.")] = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Fit an analytic model to all incidences and channels; find the model that the data support."""
    fixed = _numbers(fix)
    tint = _tint(colour, colour_from, illuminant)
    if tint is not None and to is None:
        raise typer.BadParameter(
            "only the written materials have a colour: give --out", param_hint="--colour"
        )
    if as_visible and to is None:
        raise typer.BadParameter(
            "only the written materials are labelled: give --out", param_hint="--as-visible"
        )
    with progress_bar(hidden=json) as progress:
        found = (
            _of_sphere(sphere, model, fixed)
            if measurement is None
            else gonio.fit(
                measurement,
                model=model,
                models=models or [],
                channels=channel,
                component=component,
                metric=metric,
                loss=loss,
                weights=weights,
                by_solid_angle=by_solid_angle,
                fixed=fixed,
                max_theta_s=max_theta_s,
                retro_radius=retro_radius,
                signature=signature,
                u_relative=u_relative,
                u_floor=u_floor,
                sphere=sphere,
                progress=progress,
            )
        )
        saved = None
        if to is not None:
            saved = save_fit(
                found,
                out=to,
                measurement=measurement,
                name=name,
                colour=tint,
                illuminant=illuminant,
                as_visible=as_visible,
                force=force,
                progress=progress,
            )
    if json:
        print_json(found.to_dict() | {"saved": None if saved is None else saved.to_dict()})
        return
    warn([w.text for w in found.warnings])
    _print_fit(found)
    if found.ranking is not None:
        _print_ranking(found.ranking)
    if saved is not None:
        for file, reason in saved.refused.items():
            out.print(f"no {file}: {reason}")
        for file, substitute in saved.substituted.items():
            out.print(f"{file}: {substitute.text}", style="bold")
        warn([f"{file}: {s.warning}" for file, s in saved.substituted.items() if s.warning is not None])
        for file, notes in saved.notes.items():
            for text in notes:
                out.print(f"{file}: {text}")
        for file, losses in saved.losses.items():
            for text in losses:
                out.print(f"{file}: {text}")
        out.print(f"{saved.out}: {', '.join(saved.files)}")


def _of_sphere(sphere: Path | None, model: str, fixed: dict[str, float]) -> gonio.Fit:
    """The fit to readings of a sphere alone."""
    if sphere is None:
        raise typer.BadParameter("missing, allowed a measurement, or --sphere", param_hint="MEASUREMENT")
    if model == "auto":
        raise typer.BadParameter(
            "found auto with readings of a sphere alone, allowed one model, such as plastic",
            param_hint="--model",
        )
    return gonio.fit_sphere(sphere, model=model, fixed=fixed)


def _print_sphere(found: gonio.Fit) -> None:
    """Readings of a sphere beside the model, each with its cone."""
    for s in found.sphere:
        cone = "" if s.half_angle is None else f" (all but the cone of {s.half_angle:.4g} deg)"
        before = "" if s.before is None else f", {s.before:.4f} ± {s.u_before:.2g} without it"
        out.print(
            f"  sphere, {s.component} at theta_i {s.theta_i:.4g}, {s.channel}, {s.part}{cone}: "
            f"{s.value:.4f} ± {s.u:.2g}; model {s.predicted:.4f}{before}"
        )


def _print_fit(found: gonio.Fit) -> None:
    """The parameters and how well they describe the readings."""
    channels = ", ".join(found.channels) if len(found.channels) <= 4 else f"{len(found.channels)} channels"
    out.print(f"{found.model}: {found.title}", style="bold")
    out.print(f"  {found.readings} readings, {channels}, metric {found.metric}", end="")
    left_out = ", ".join(f"{n} {reason.replace('_', ' ')}" for reason, n in found.excluded.items())
    out.print(f"; left out: {left_out}" if left_out else "")
    if found.residuals:
        out.print(f"  residuals are typically {found.noise_ratio:.3g} times the stated noise")
    width = max(len("parameter"), *(len(e.label) for e in found.estimates))
    out.print(f"  {'parameter':<{width}}  {'value':>11}  {'u':>9}  {'95 % interval':<24}  {'u_model':>9}")
    for e in found.estimates:
        out.print(f"  {e.label:<{width}}  {_row(e)}")
    _print_sphere(found)
    for c in found.notable_correlations:
        out.print(f"  correlation of {c.first} and {c.second}: {c.value:+.2f}")
    if found.held_out:
        worst = max(found.held_out, key=lambda h: h.relative_l1)
        out.print(
            f"  error at left-out incidences {100 * (found.held_out_error or 0.0):.2f} % (relative L1), "
            f"worst at theta_i {worst.theta_i:.4g} ({100 * worst.relative_l1:.2f} %)"
        )


def _row(e: gonio.Estimate) -> str:
    unit = "" if e.unit == "1" else f" {e.unit}"
    if e.kind == "fixed":
        return f"{e.value:>11.6g}  fixed{unit}"
    if e.kind == "upper_limit":
        return f"{'< ' + format(e.high, '.4g'):>11}  upper limit{unit}: the beam hides the lobe"
    if e.kind == "undetermined":
        return f"{'-':>11}  undetermined: the readings do not depend on it"
    ends = f"{e.low:.6g} to {e.high:.6g}"
    profile = ", profile" if e.interval == "profile" else ""
    return f"{e.value:>11.6g}  {e.u:>9.2g}  {ends:<24}  {e.u_model:>9.2g}{unit}{profile}"


def _print_ranking(ranking: gonio.Ranking) -> None:
    """Every model with its errors, then what they say."""
    rows = ranking.to_dict()["models"]
    width = max(len("model"), *(len(row["model"]) for row in rows))
    out.print(f"  {'model':<{width}}  {'left-out error':>14}  {'worst at':>20}  {'AICc':>9}  written for")
    for row in rows[:SHOWN]:
        error, worst = row["held_out_error"], row["worst_error"]
        shown = "-" if error is None else f"{100 * error:.2f} %"
        at = "-" if worst is None else f"{row['worst_theta_i']:.4g} deg: {100 * worst:.2f} %"
        programs = ", ".join(row["materials"]) or "-"
        delta = "-" if row["delta_aicc"] is None else f"{row['delta_aicc']:+.1f}"
        out.print(f"  {row['model']:<{width}}  {shown:>14}  {at:>20}  {delta:>9}  {programs}")
    if len(rows) > SHOWN:
        out.print(f"  and {len(rows) - SHOWN} that fit worse")
    for model, reason in ranking.failed.items():
        out.print(f"  {model}: {reason}")
    out.print(ranking.sentence, style="bold")


def _numbers(fix: list[str] | None) -> dict[str, float]:
    fixed = {}
    for name, text in pairs(fix or [], option="--fix").items():
        try:
            fixed[name] = float(text)
        except ValueError:
            raise typer.BadParameter(f"found {name}={text!r}, allowed a number", param_hint="--fix") from None
    return fixed


def _tint(colour: str | None, colour_from: Path | None, illuminant: str) -> tuple[float, float, float] | None:
    if colour is not None and colour_from is not None:
        raise typer.BadParameter("found --colour-from beside it, allowed one", param_hint="--colour")
    if colour_from is not None:
        found = gonio.colour(colour_from, illuminant=illuminant)[0]
        warn(found.warnings)
        return found.rgb
    if colour is None:
        return None
    try:
        red, green, blue = (float(part) for part in colour.split(","))
    except ValueError:
        raise typer.BadParameter(f"found {colour!r}, allowed R,G,B", param_hint="--colour") from None
    check_tint((red, green, blue))
    return red, green, blue
