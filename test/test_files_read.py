"""Which modules open files: those that doc/security.md names, and no others."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "robomech_ros"
PAGE = ROOT / "doc" / "security.md"
# What people run by hand reads what they name.
BY_HAND = ("cli", "plotting", "nodes/commands", "nodes/demonstration")
OPENING = {
    "open", "fdopen", "read_text", "read_bytes", "open_regular", "read_regular", "fromfile",
    "loadtxt", "genfromtxt", "memmap", "parse",
}  # fmt: skip


def opened_in(path: Path) -> set[str]:
    """Name the functions that open files and are called in a module."""
    found = set()
    text = path.read_text(encoding="utf-8")
    # robots/documents/yaml_rows.py has a read_text of its own, for a value of a document.
    of_yaml = "yaml_rows import" in text or "def read_text" in text
    for node in ast.walk(ast.parse(text)):
        if not isinstance(node, ast.Call):
            continue
        called = node.func
        if isinstance(called, ast.Attribute) and called.attr in OPENING:
            found.add(called.attr)
        if (
            isinstance(called, ast.Name)
            and called.id in OPENING
            and not (called.id == "read_text" and of_yaml)
        ):
            found.add(called.id)
    return found


@pytest.mark.slow
def test_no_other_module_opens_files():
    table = PAGE.read_text(encoding="utf-8").split("## Files\n")[1]
    # Tests are named there, too.
    named = {name for name in re.findall(r"`([\w/]+\.py)`", table) if "test_" not in name}
    opening = set()
    for path in PACKAGE.rglob("*.py"):
        place = path.relative_to(PACKAGE).as_posix()
        if not place.startswith(BY_HAND) and opened_in(path):
            opening.add(place)
    assert opening == named


def test_the_search_finds_what_it_should(tmp_path):
    module = tmp_path / "module.py"
    for line in ("open(p)", "os.open(p, 0)", "p.read_text()", "np.fromfile(p)", "p.open('rb')"):
        module.write_text(line, encoding="utf-8")
        assert opened_in(module), line
    module.write_text("from robots.documents.yaml_rows import read_text\nread_text(value, w)")
    assert not opened_in(module)
