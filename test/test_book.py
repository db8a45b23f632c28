"""The page that leads from the book's sections to functions: names, golden files, completeness."""

import inspect
import pkgutil
import re
from importlib import import_module
from pathlib import Path

import pytest

import robomech_ros
from robomech_ros.hands import list_hands
from robomech_ros.parallel import list_parallel
from robomech_ros.robots import list_robots
from robomech_ros.rolling import list_rolling
from robomech_ros.walking import list_legged

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
# The book's own contents: numbers and titles, exercises left out.
CONTENTS = [
    line.split(" ", 1)
    for line in (ROOT / "test/data/book_contents.txt").read_text(encoding="utf-8").splitlines()
]
INTRODUCTIONS = ("Introduction", "Preamble")
LEFT_OUT = ("Swimming Robots", "Flying Robots")


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


def test_every_section_has_a_row_with_the_number_and_title_of_the_contents():
    # An appendix without sections is one itself.
    sections = [[number, title] for number, title in CONTENTS if "." in number or number == "A"]
    assert len(sections) > 140
    assert [row[:2] for row in ROWS] == sections


def test_chapters_have_the_titles_of_the_contents():
    heads = re.findall(r"^## (?:Chapter|Appendix) (\w+): (.*)$", PAGE, re.MULTILINE)
    chapters = [(number, title) for number, title in CONTENTS if "." not in number]
    assert heads == chapters


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_a_row_has_functions_unless_it_is_an_introduction(row):
    _, title, functions, golden, notebook = row
    if title in INTRODUCTIONS:
        assert functions == "no algorithm"
    elif title in LEFT_OUT:
        assert functions == "left out"
    else:
        assert "`" in functions or re.match(r"see (\d|\[)", functions)
    assert "`" in functions or not golden
    assert "`" not in functions or notebook.startswith("[")


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


def test_the_classes_of_robots_name_every_robot_twice():
    """Once by function, and once by application."""
    page = (ROOT / "doc" / "classes_of_robots.md").read_text(encoding="utf-8")
    by_function, rest = page.split("## By size")
    by_application = rest.split("## By application")[1].split("\n## ")[0]
    robots = [
        *list_robots(), *list_parallel(), *list_hands(), *list_legged(), *list_rolling()
    ]  # fmt: skip
    for part in (by_function.split("## By function")[1], by_application):
        named = re.findall(r"`(\w+)`", part)
        assert sorted(named) == sorted(robots)
