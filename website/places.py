"""Where pages that are made, and not written, lie in the site."""

SOLVERS = "reference/solvers"
AUDITS = "validation/tables"
# Pages that are made of files beside docs/.
MADE_OF = {"README.md": "tour.md", "benchmarks/README.md": "benchmarks.md"}
