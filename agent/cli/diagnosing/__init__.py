"""DIAGNOSE: recordings worked out on all cores, their pictures, table and report."""
