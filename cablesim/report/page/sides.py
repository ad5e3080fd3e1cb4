"""What stands at the sides of an interactive figure."""

import re
from typing import Any

from cablesim.report.drawing import formula_label

TEX = {r"\varepsilon": "ε", r"\eta": "η", r"\phi": "φ", r"\beta": "β", r"\rho": "ρ", r"\psi": "ψ", r"\alpha": "α"}


def side(settings: dict[str, Any], name: str) -> str:
    """The words of a side."""
    text = settings.get(f"{name}_label") or formula_label(settings[name])
    return re.sub(r"[{}$\\]", "", re.sub(r"\\\w+", lambda m: TEX.get(m[0], m[0]), text))
