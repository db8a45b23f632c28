"""Show the notebooks: a gallery of their pictures, a table of their contents, and 3D scenes."""

import shutil
from html import escape
from pathlib import Path, PurePosixPath

from docutils import nodes
from myst_nb.sphinx_ import NbMetadataCollector
from notebook_parts import assertions, exercises
from PIL import Image
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

INDEX = "notebooks/index"
THUMBNAIL = (400, 300)  # largest width and height, px
HEADINGS = ("Assertions", "Exercises", "Run time (s)")
LOG = logging.getLogger(__name__)


class GalleryNode(nodes.General, nodes.Element):
    """Placeholder of the gallery until all notebooks have run."""


class Gallery(SphinxDirective):
    """The gallery: one picture of each notebook, which leads to it."""

    def run(self) -> list[nodes.Node]:
        """Return the placeholder."""
        return [GalleryNode()]


class FillGallery(SphinxPostTransform):
    """Replace the placeholder by the pictures."""

    default_priority = 20
    formats = ("html",)

    def run(self, **options: object) -> None:
        """Fill the galleries of a page."""
        for gallery in list(self.document.findall(GalleryNode)):
            cards = "".join(map(self._card, self.env.toctree_includes[INDEX]))
            text = f'<div class="gallery">{cards}</div>'
            gallery.replace_self(nodes.raw("", text, format="html"))

    def _card(self, notebook: str) -> str:
        title = escape(self.env.titles[notebook].astext())
        address = self.app.builder.get_relative_uri(self.env.docname, notebook)
        picture = self._thumbnail(notebook)
        return f'<a href="{address}"><img src="{picture}" alt="" loading="lazy">{title}</a>'

    def _thumbnail(self, notebook: str) -> str:
        """Write the first picture of a notebook in small, and return its address."""
        first = next(self.env.get_doctree(notebook).findall(nodes.image), None)
        if first is None:
            LOG.warning("%s has no picture for the gallery", notebook)
            return ""
        source = Path(self.env.srcdir, first["uri"])
        folder = Path(self.app.outdir, "_images")
        folder.mkdir(exist_ok=True)
        path = folder / f"thumbnail_{PurePosixPath(notebook).name}.png"
        with Image.open(source) as picture:
            picture.thumbnail(THUMBNAIL)
            picture.save(path, optimize=True)
        base = self.app.builder.get_relative_uri(self.env.docname, "index")
        return str(PurePosixPath(base).parent / "_images" / path.name)


class CompleteTable(SphinxPostTransform):
    """Append what the build knows of each notebook to the table of notebooks."""

    default_priority = 20  # when links to documents are resolved
    formats = ("html",)

    def run(self, **options: object) -> None:
        """Append columns to the first table of the page."""
        table = next(self.document.findall(nodes.table), None)
        if self.env.docname != INDEX or table is None:
            return
        group = table.next_node(nodes.tgroup)
        group["cols"] += len(HEADINGS)
        for _ in HEADINGS:
            group.insert(0, nodes.colspec(colwidth=1))
        for row in group.findall(nodes.row):
            link = row.next_node(nodes.reference)
            texts = self._facts(link) if link else HEADINGS
            row += [nodes.entry("", nodes.paragraph(text=text)) for text in texts]

    def _facts(self, link: nodes.reference) -> tuple[str, str, str]:
        notebook = f"notebooks/{PurePosixPath(link['refuri']).stem}"
        text = Path(self.env.doc2path(notebook)).read_text("utf-8")
        run = NbMetadataCollector.get_doc_data(self.env)[notebook].get("exec_data")
        seconds = f"{run['runtime']:.1f}" if run else "not run"
        return str(assertions(text)), str(exercises(text)), seconds


class Scene(SphinxDirective):
    """A 3D scene that a cell of the notebook has written as a page of its own."""

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        """Return the scene in a frame, and its caption."""
        file = self.arguments[0]
        if not self._path(file).is_file():
            raise self.error(f"no cell of this notebook has written {file}")
        self.env.metadata[self.env.docname].setdefault("scenes", []).append(file)
        frame = f'<iframe class="scene" data-src="{file}" title="{file}"></iframe>'
        caption = nodes.caption()
        self.state.nested_parse(self.content, self.content_offset, caption)
        return [nodes.raw("", frame, format="html"), *caption.children]

    def _path(self, file: str) -> Path:
        return Path(self.env.doc2path(self.env.docname)).parent / file


def move_scenes(app: Sphinx, error: Exception | None) -> None:
    """Move the scenes from the folder where cells run to the pages that show them."""
    for notebook, found in app.env.metadata.items():
        for file in found.get("scenes", ()):
            source = Path(app.env.doc2path(notebook)).parent / file
            if error is None and source.is_file():
                shutil.move(source, Path(app.outdir, notebook).parent / file)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the extension."""
    app.add_node(GalleryNode)
    app.add_directive("gallery", Gallery)
    app.add_directive("scene", Scene)
    app.add_post_transform(FillGallery)
    app.add_post_transform(CompleteTable)
    app.connect("build-finished", move_scenes)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
