"""Tables of benchmarks: quantiles, strata, targets, Markdown."""
