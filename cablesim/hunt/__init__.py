"""The search for answers that are wrong without saying so: random and adversarial scenarios, judged.

A module here whose name has no underscore is a family of solvers, found by looking into the folder:

    SOLVERS   the solvers that it draws scenarios for and judges
    WEIGHTS   (optional) how many scenarios a solver gets beside others, by what they cost; 1 without it
    draw(solver, size, rng) -> list[Case]
    judges(solver) -> dict[str, Judge]   by name, laws first, then a second method

A solver of no family is drawn from its declared ranges and judged by what holds for all (`_anything`).
"""
