"""Let the search list first the page that answers a word of a newcomer."""

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform
from words_of_pages import WORDS


class AddSearchWords(SphinxTransform):
    """Add the words of a page to the index; the search lists entries of the index first."""

    default_priority = 800  # before the index is collected

    def apply(self, **options: object) -> None:
        """Add the words of one page."""
        words = WORDS.get(self.env.docname, ())
        if words:
            title = next(self.document.findall(nodes.section))["ids"][0]
            entries = [("single", word, title, "main", None) for word in words]
            self.document.insert(0, addnodes.index(entries=entries))


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the extension."""
    app.add_transform(AddSearchWords)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
