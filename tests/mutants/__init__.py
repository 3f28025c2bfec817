"""Known mistakes, put into a copy of the scattering models one at a time: a test must notice each."""
