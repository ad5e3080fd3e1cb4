"""One module for each method; found by looking into this folder."""
