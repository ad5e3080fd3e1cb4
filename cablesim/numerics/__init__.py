"""Methods that know no physics: exact arithmetic, functions without cancellation, roots of many equations at once."""

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]
