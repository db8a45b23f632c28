"""The page that leads from the book's sections to functions: names, golden files, completeness."""

import inspect
import pkgutil
import re
from importlib import import_module
from pathlib import Path

import pytest

import robomech_ros

ROOT = Path(__file__).resolve().parent.parent
GOLDEN = ROOT / "test" / "data" / "golden"
PAGE = (ROOT / "doc" / "book.md").read_text(encoding="utf-8")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.splitlines()
    if re.match(r"\| (?:\d+|[AB])[. \\]", line)
]
NAMES = sorted(
    set(re.findall(r"`((?:[a-z_]+\.)+\w+)`", PAGE)) - set(re.findall(r"`(\w+\.json)`", PAGE))
)
# How many sections each chapter or appendix has, and how many subsections each of these.
SECTIONS = {
    "2": (0, 0, 6, 0, 3, 0, 1),
    "3": (0, 3, 0, 2, 0, 0, 0, 0),
    "4": (0, 0, 0, 2),
    "5": (0, 0, 0, 1, 0, 0, 4, 4),
    "6": (0, 0, 2, 0, 0, 0),
    "7": (0, 0, 3, 2, 2, 3, 0, 0),
    "8": (0, 1, 1),
    "9": (0, 2, 2, 1, 0, 3, 0),
    "10": (0, 1, 0, 0, 2),
    "11": (0, 0, 0, 0, 0),
    "12": (0, 0, 0, 0, 2),
    "A": (),
    "B": (1, 1, 1, 2),
}


def numbered():
    """Every section number in the book's order; an appendix without sections is one itself."""
    for chapter, counts in SECTIONS.items():
        if not counts:
            yield chapter
        for section, count in enumerate(counts, start=1):
            yield f"{chapter}.{section}"
            yield from (f"{chapter}.{section}.{k}" for k in range(1, count + 1))


def public_functions():
    """Every function that a package of the core exports, as the page names it."""
    for package in pkgutil.iter_modules(robomech_ros.__path__):
        if not package.ispkg or package.name in ("_kernels", "nodes", "errors"):
            continue
        module = import_module(f"robomech_ros.{package.name}")
        for name in getattr(module, "__all__", ()):
            if inspect.isfunction(getattr(module, name)):
                yield f"{package.name}.{name}"


def named(name):
    """Import what a dotted name stands for."""
    parts = name.split(".")
    value = import_module(f"robomech_ros.{parts[0]}")
    for k, part in enumerate(parts[1:], start=1):
        try:
            value = getattr(value, part)
        except AttributeError:
            value = import_module(".".join(["robomech_ros", *parts[: k + 1]]))
    return value


def test_every_section_has_a_row_in_the_order_of_the_book():
    assert [row[0].rstrip("\\*") for row in ROWS] == list(numbered())


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_a_row_has_functions_or_says_why_not(row):
    _, title, functions, golden, _ = row
    assert title
    words = ("no algorithm", "not yet")
    assert "`" in functions or functions.startswith("see ") or functions in words
    assert "`" in functions or not golden


@pytest.mark.parametrize("name", NAMES)
def test_every_name_can_be_imported(name):
    assert named(name) is not None


def test_every_public_function_has_a_row():
    functions = set(public_functions())
    assert len(functions) > 150
    assert functions <= set(NAMES), f"not in doc/book.md: {sorted(functions - set(NAMES))}"


def test_the_golden_files_are_all_there_and_all_named():
    assert {cell for row in ROWS for cell in re.findall(r"`([^`]+)`", row[3])} == {
        path.name for path in GOLDEN.glob("*.json")
    }
