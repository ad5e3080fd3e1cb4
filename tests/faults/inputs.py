"""Faults of what a user writes: scenes, names, queries, parameters and tolerances that are hostile or not numbers."""

from tests.faults.fault import Fault

FAULTS: tuple[Fault, ...] = ()
