"""Cases of benchmarks: one loop, simulated or recorded, with its results."""
