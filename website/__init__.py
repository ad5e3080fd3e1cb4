"""What turns docs/, the package and a finished study into the site: see mkdocs.yml."""
