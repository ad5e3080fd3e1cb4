"""The quick part of the fault programme: each fault a few times."""

import pytest

from tests.faults.__main__ import FAULTS

SEED = 1


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_fault_is_survived(fault, tmp_path):
    outcome = fault.inject(tmp_path, fault.quick, SEED)
    if not outcome.injected:
        pytest.skip(outcome.figures)
    assert outcome.injected >= fault.quick
    assert not outcome.failures
