"""Tables of numbers: hemispherical integrals and what is known of each slice."""

from gonio._drawing.directions import component_of
from gonio._drawing.numbers import angle, number, percent, with_uncertainty
from gonio.reporting.drawn import DrawnSlice
from gonio.reporting.header import grouped
from gonio.reporting.wording import channel_label


def integral_rows(
    drawn: list[DrawnSlice], truths: dict[tuple[int, str], float | None]
) -> list[dict[str, str]]:
    """One row a slice and hemisphere: DHR or DHT with its expanded uncertainty and the extrapolated share.

    `truths` are known values by key of the slice and side; a row then tells the difference, too.
    """
    rows = []
    for d in drawn:
        s = d.slice
        for integral in s.integrals:
            truth = truths.get((d.key, str(integral.side)))
            component = component_of(float(s.theta_i), str(integral.side))
            value, extrapolated = float(integral.value), float(integral.extrapolated)
            rows.append(
                {
                    "theta_i": angle(float(s.theta_i)),
                    "phi_i": angle(float(s.phi_i)),
                    "channel": channel_label(s.channel),
                    "quantity": "DHR" if component == "reflection" else "DHT",
                    "value": with_uncertainty(value, float(integral.u)),
                    "extrapolated": percent(extrapolated / value) if value else "—",
                    "truth": "—" if truth is None else _beside(truth, value, float(integral.u)),
                    "difference": percent(value / truth - 1.0, sign=True) if truth else "—",
                }
            )
    return rows


def _beside(truth: float, value: float, u: float) -> str:
    """Write a true value with as many decimals as the measured one beside it."""
    measured = with_uncertainty(value, u).split(" ")[0]
    return f"{truth:.{len(measured.partition('.')[2])}f}" if measured.count("·") == 0 else number(truth, 4)


def slice_facts(d: DrawnSlice) -> list[tuple[str, str]]:
    """List what the reader needs beside the pictures of one slice."""
    count = max(d.readings, 1)
    return [
        ("Readings", grouped(d.readings)),
        ("Drawn", grouped(d.drawn)),
        ("Peak DSF", f"{number(d.peak, 3)} 1/sr"),
        ("Noise floor (2 u)", f"{number(d.floor, 2)} 1/sr" if d.floor else "not known"),
        ("Negative", f"{grouped(d.negative)} ({percent(d.negative / count, 1)})"),
        ("Below noise", f"{grouped(d.below_noise)} ({percent(d.below_noise / count, 1)})"),
        ("Not usable", grouped(d.unusable)),
    ]


def drawn_facts(drawn: list[DrawnSlice]) -> list[list[tuple[str, str]]]:
    """`slice_facts` of every slice, in the order of the payload."""
    return [slice_facts(d) for d in drawn]


def columns(drawn: list[DrawnSlice]) -> dict[str, bool]:
    """Tell which of the columns that often hold one value only are worth showing."""
    return {"phi_i": several_azimuths(drawn), "channel": len({d.slice.channel for d in drawn}) > 1}


def several_azimuths(drawn: list[DrawnSlice]) -> bool:
    """Tell whether oblique incidences come from several azimuths; at the normal an azimuth means nothing."""
    return len({round(d.slice.phi_i, 3) for d in drawn if 0.01 < d.slice.theta_i < 179.99}) > 1
