"""Words by which newcomers search, each with the page that answers: the search lists it first."""

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform

PAGES = {
    "real_robot": ("real robot", "my robot", "UR", "driver", "ros2_control", "remapping"),
    "moveit": ("MoveIt", "pymoveit2", "MoveGroupInterface"),
    "tool": ("tool", "TCP", "tool centre point", "tool center point"),
    "grippers": ("gripper",),
    "limits": ("limits", "joint limits", "velocity limits"),
    "collisions": ("collisions", "obstacles", "self-collisions"),
    "several_robots": ("several robots", "two robots", "multiple robots", "namespace"),
    "distributions": ("ROS distributions", "Humble", "Jazzy", "Kilted", "Rolling"),
    "docker": ("Docker", "container"),
    "platforms": ("platforms", "aarch64", "ARM", "macOS", "Windows"),
    "citing": ("citing", "cite", "citation"),
}


class AddSearchWords(SphinxTransform):
    """Add the words of a page to the index, which the search asks first."""

    default_priority = 800  # before the index is collected

    def apply(self, **options: object) -> None:
        """Add the words of one page."""
        words = PAGES.get(self.env.docname, ())
        if words:
            title = next(self.document.findall(nodes.section))["ids"][0]
            entries = [("single", word, title, "main", None) for word in words]
            self.document.insert(0, addnodes.index(entries=entries))


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the extension."""
    app.add_transform(AddSearchWords)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
