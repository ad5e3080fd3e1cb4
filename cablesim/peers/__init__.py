"""Thin adapters to other people's programs, and to what users of SciPy would write: to compare with."""
