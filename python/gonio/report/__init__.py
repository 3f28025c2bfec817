"""The self-contained HTML report of a measurement: one file that opens offline."""

from gonio.report.page import render_report

__all__ = ["render_report"]
