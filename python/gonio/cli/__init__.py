"""The command line: one verb a file, each a thin layer over the Python function of the same name."""

from gonio.cli.app import main

__all__ = ["main"]
