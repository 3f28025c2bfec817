"""Tests of samplers that need other programs; those that need none are crates/bsdf/tests/statistical."""
