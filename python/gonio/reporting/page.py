"""Put the report together and write it in one piece."""

import os
from collections.abc import Sequence
from importlib import metadata, resources
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from plotly.offline import get_plotlyjs

from gonio._drawing import numbers
from gonio._drawing.shapes import BsdfLike, MeasurementLike, VerdictLike
from gonio.files import replacing_file
from gonio.reporting import compare, glossary, header, provenance, sparkline, tables
from gonio.reporting.drawn import draw_all
from gonio.reporting.payload import build_payload, to_json
from gonio.reporting.wording import in_symbols

SCRIPTS = ("base.js", "data.js", "dhr.js", "profile.js", "lobe.js", "heatmap.js", "main.js")
"""Scripts of the page in the order in which they are inlined."""


def render_report(
    measurement: MeasurementLike,
    verdicts: Sequence[VerdictLike],
    *,
    out: str | os.PathLike[str],
    truth: BsdfLike | None = None,
    model: BsdfLike | None = None,
    title: str | None = None,
) -> Path:
    """Write the report of a measurement as one HTML file that needs nothing else, not even a network.

    At most about 120,000 readings are drawn; a larger measurement is thinned where neighbours agree, every
    peak is kept, and the page says how many readings it draws. Profiles and all numbers come from the whole
    measurement.

    Parameters
    ----------
    measurement
        The processed sample; every incidence becomes one position of the slider.
    verdicts
        The outcome of the checks, shown in the given order.
    out
        File to write; an existing one is replaced only when the new one is complete.
    truth
        The known scattering function of a simulated sample, drawn over the readings, with residuals.
    model
        A model built from the readings, drawn over them, with residuals.
    title
        Heading; the sample's name without one.

    Returns
    -------
    Path
        The file that was written.

    Raises
    ------
    OSError
        `out` cannot be written; nothing is left behind.
    """
    references = [
        compare.Reference(name, label, bsdf)
        for name, label, bsdf in (("truth", "known truth", truth), ("model", "model", model))
        if bsdf is not None
    ]
    drawn = draw_all(list(measurement.slices))
    truths = {
        (d.key, str(i.side)): compare.hemispherical_truth(truth, d.slice, str(i.side))
        for d in drawn
        for i in d.slice.integrals
    }
    payload = build_payload(measurement, drawn, references, truths)
    integrals = tables.integral_rows(drawn, truths)
    warnings = list(dict.fromkeys(in_symbols(str(w)) for w in measurement.warnings))
    page = (
        environment()
        .get_template("report.html.j2")
        .render(
            head=header.describe(measurement, verdicts, title=title, drawn=drawn),
            verdicts=[header.verdict_row(v) for v in verdicts],
            integrals=integrals,
            show=tables.columns(drawn),
            several_phi=tables.several_azimuths(drawn),
            channels=payload["channels"],
            two_sided=len(payload["sides"]) > 1,
            incidences=sparkline.cards(drawn),
            facts=Markup(to_json(tables.drawn_facts(drawn))),
            residuals=compare.residual_rows(drawn, references),
            references=[r.label for r in references],
            known_truth=any(value is not None for value in truths.values()),
            extrapolates=any(row["extrapolated"] != "0.00 %" for row in integrals),
            warnings=warnings,
            provenance=provenance.sections(measurement.provenance),
            glossary=glossary.TERMS,
            version=metadata.version("gonio"),
            style=static("style.css"),
            scripts=[static(name) for name in SCRIPTS],
            plotly=Markup(get_plotlyjs()),
            payload=Markup(to_json(payload)),
        )
    )
    path = Path(out)
    with replacing_file(path) as temporary:
        temporary.write_text(page, encoding="utf-8", newline="\n")
    return path


def environment() -> Environment:
    """Give the templates of the pages."""
    made = Environment(
        loader=PackageLoader("gonio.reporting"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters["number"] = numbers.number
    made.filters["percent"] = numbers.percent
    return made


def static(name: str) -> Markup:
    """Read a script or style sheet that a page inlines."""
    return Markup((resources.files("gonio.reporting") / "static" / name).read_text(encoding="utf-8"))
