"""Formulas of lines; they know no numerical method and no file."""
