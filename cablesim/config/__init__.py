"""Reading what people write: scene files, tables and designs, strictly, each error with its place."""
