"""Shards, datasets, queries and comparisons: files know datasets, not physics."""

CATALOGUE_FILE = "catalogue.parquet"
