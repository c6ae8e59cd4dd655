"""Cases of benchmarks: one loop, simulated or recorded, and what was made of it."""
