"""Shards, datasets, queries and comparisons: files know datasets, not physics."""
