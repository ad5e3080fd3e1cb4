"""Faults of files that are there: damaged, cut short, swapped, foreign, copied, with clocks that are wrong."""

from tests.faults.fault import Fault

FAULTS: tuple[Fault, ...] = ()
