"""Side-by-side benchmarks against peers: every module with a `run` gives records, ratios within one run."""
