"""EVIDENCE: all methods weighed against each other, in one record or in several of one valve."""
