"""Write the pages that are made of the sources and of a finished study; mkdocs-gen-files runs it in every build."""

import mkdocs_gen_files

from website import gallery, home, reference, references, solvers, validation
from website.study import finished

study = finished(mkdocs_gen_files.config)
pages = {
    **home.pages(),
    **gallery.pages(study),
    **validation.pages(study),
    **references.pages(),
    **reference.pages(),
    **solvers.pages(),
}
for name, text in pages.items():
    with mkdocs_gen_files.open(name, "w") as page:
        page.write(text)
for name, source in gallery.pictures(study).items():
    with mkdocs_gen_files.open(name, "wb") as picture, source.open("rb") as file:
        picture.write(file.read())
