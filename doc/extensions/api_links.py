"""Link names in running text to their entries in the Python interface."""

import re

from docutils import nodes
from public_names import ROOT, full_names
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util import logging
from sphinx.util.nodes import make_refnode

# The page that maps sections to functions, the rows of its tables, and the label of a row.
BOOK, NUMBER, LABEL = "book", re.compile(r"([0-9]+|[AB])(\.[0-9]+)*"), "book-{}"
DOTTED = re.compile(r"([a-z_]+\.)+\w+")
LOG = logging.getLogger(__name__)


class LinkNames(SphinxPostTransform):
    """Make a link of each literal that is the name of something public."""

    default_priority = 400
    formats = ("html",)

    def run(self, **options: object) -> None:
        """Link the names of one page."""
        entries = self.env.get_domain("py").objects
        alone = full_names()
        for literal in list(self.document.findall(nodes.literal)):
            text = literal.astext().removesuffix("()")
            candidates = (text, f"robomech_ros.{text}", alone.get(text, ""))
            full = next((name for name in candidates if name in entries), None)
            if full and not _inside_link(literal):
                to, page = entries[full], self.env.docname
                link = (self.app.builder, page, to.docname, to.node_id, literal.deepcopy(), full)
                literal.replace_self(make_refnode(*link))
            elif self.env.docname == BOOK and not full and _is_ours(text):
                LOG.warning("%s has no entry in the Python interface", text, location=literal)


def _inside_link(node: nodes.Node) -> bool:
    kinds = (nodes.reference, nodes.title)
    while node is not None and not isinstance(node, kinds):
        node = node.parent
    return node is not None


def _is_ours(text: str) -> bool:
    first = text.partition(".")[0]
    is_module = (ROOT / "robomech_ros" / first).is_dir() and not text.endswith(".json")
    return is_module and bool(DOTTED.fullmatch(text))


def label_sections(app: Sphinx, document: nodes.document) -> None:
    """Give each row of the page of the book a label by its section, such as ``book-4.4.1``."""
    if app.env.docname != BOOK:
        return
    domain = app.env.get_domain("std")
    labels, anonymous = domain.labels, domain.anonlabels
    for row in document.findall(nodes.row):
        number = row[0].astext()
        if NUMBER.fullmatch(number):
            anchor = f"section-{number.replace('.', '-')}"
            row[0]["ids"].append(anchor)
            labels[LABEL.format(number).lower()] = (BOOK, anchor, number)
            anonymous[LABEL.format(number).lower()] = (BOOK, anchor)


def resolve_public_name(
    app: Sphinx, env: BuildEnvironment, node: addnodes.pending_xref, content: nodes.Node
) -> nodes.reference | None:
    """Find what a role such as ``:func:`` names without its package."""
    name = full_names().get(node.get("reftarget", ""))
    entry = env.get_domain("py").objects.get(name or "")
    if node.get("refdomain") != "py" or entry is None:
        return None
    return make_refnode(app.builder, node["refdoc"], entry.docname, entry.node_id, content, name)


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the extension."""
    app.add_post_transform(LinkNames)
    app.connect("doctree-read", label_sections)
    app.connect("missing-reference", resolve_public_name)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
