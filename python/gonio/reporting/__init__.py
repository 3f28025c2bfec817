"""The self-contained HTML report of a measurement: one file that opens offline."""

from gonio.reporting.verb import report

__all__ = ["report"]
