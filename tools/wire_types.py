"""The packages of compat/: message types that the wheels of ROS 2 lack."""

from __future__ import annotations

from graphlib import TopologicalSorter
from pathlib import Path
from xml.etree import ElementTree

FOLDER = Path(__file__).resolve().parent.parent / "compat"

# Run by the Python of an environment with the name of a package: ends with 0 if the package is
# there and did not come from here.
IS_REAL = """
import importlib.metadata, importlib.util, sys
name = sys.argv[1]
ours = "robomech-compat-" + name.replace("_", "-")
names = [found.name for found in importlib.metadata.distributions()]
sys.exit(ours in names or importlib.util.find_spec(name) is None)
"""


def packages() -> list[Path]:
    """Return the folders of the packages, each after those that it depends on."""
    depends = {}
    for manifest in sorted(FOLDER.glob("*/package.xml")):
        entries = ElementTree.parse(manifest).getroot().findall("depend")
        depends[manifest.parent.name] = [str(entry.text) for entry in entries]
    order = TopologicalSorter(depends).static_order()
    return [FOLDER / name for name in order if name in depends]
