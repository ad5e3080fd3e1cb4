"""Flexible lines: models, scenario database and batch pipeline."""
