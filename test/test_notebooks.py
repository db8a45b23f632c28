"""The notebooks in doc/notebooks: all cells run, and the index lists all of them."""

import re
import sys
from pathlib import Path

import pytest

matplotlib = pytest.importorskip("matplotlib")

FOLDER = Path(__file__).resolve().parent.parent / "doc" / "notebooks"
sys.path.insert(0, str(FOLDER.parent / "extensions"))

from notebook_parts import assertions, cells  # noqa: E402

NOTEBOOKS = sorted(path for path in FOLDER.glob("*.md") if path.stem != "index")


@pytest.mark.parametrize("page", NOTEBOOKS, ids=lambda page: page.stem)
def test_every_cell_runs(page, monkeypatch, tmp_path):
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {"__name__": "__main__"}
    for number, cell in enumerate(cells(page.read_text("utf-8")), start=1):
        try:
            # The empty lines give a traceback the line numbers of the page.
            exec(compile("\n" * cell.above + cell.source, str(page), "exec"), names)
        except Exception as error:
            raise AssertionError(f"{page.name}, cell {number}: {error!r}") from error
    matplotlib.pyplot.close("all")


@pytest.mark.parametrize("page", NOTEBOOKS, ids=lambda page: page.stem)
def test_a_notebook_has_all_its_parts(page):
    text = page.read_text("utf-8")
    assert text.startswith("---\nfile_format: mystnb\n")
    body, heading, exercises = text.partition("\n## Exercises\n")
    assert heading
    assert "$$" in body
    prose = re.sub(r"^(```|\$\$)\S*$.*?^\1$", "", text, flags=re.DOTALL | re.MULTILINE)
    assert not re.search(r"^[+=] ", prose, re.MULTILINE)  # a formula broken there becomes a list
    _, heading, second = body.partition("\n## A second route")
    assert heading
    assert assertions(second)
    assert assertions(body) > assertions(second)
    solutions = re.findall(r"^<details>.*?^</details>", exercises, re.DOTALL | re.MULTILINE)
    assert len(solutions) == len(re.findall(r"^\*\*\d\.\*\*", exercises, re.MULTILINE)) >= 2
    assert assertions("\n".join(solutions))


def test_the_index_lists_every_notebook():
    text = (FOLDER / "index.md").read_text("utf-8")
    rows = re.findall(r"^\| .+? \| \[.+?\]\((\w+)\.md\) \| .+? \|$", text, re.MULTILINE)
    assert rows == re.findall(r"^(\w+)$", text.partition("{toctree}")[2], re.MULTILINE)
    assert sorted(rows) == [page.stem for page in NOTEBOOKS]


def test_the_page_of_the_book_links_each_section_to_its_notebooks():
    book = (FOLDER.parent / "book.md").read_text("utf-8")
    linked = dict(re.findall(r"^\| ([0-9AB][0-9.]*) \|.*\|(.*)\|$", book, re.MULTILINE))
    index = (FOLDER / "index.md").read_text("utf-8")
    for sections, notebook in re.findall(r"^\| (.+?) \| \[.+?\]\((\w+)\.md\)", index, re.MULTILINE):
        for section in sections.split(", "):
            rows = [row for number, row in linked.items() if f"{number}.".startswith(f"{section}.")]
            assert any(f"notebooks/{notebook}.md" in row for row in rows), (section, notebook)


@pytest.mark.parametrize("page", NOTEBOOKS, ids=lambda page: page.stem)
def test_a_scene_is_written_by_a_cell(page):
    text = page.read_text("utf-8")
    source = "".join(cell.source for cell in cells(text))
    written = re.findall(r'^write_\w+\("(\w+\.html)"', source, re.MULTILINE)
    assert written == re.findall(r"^```\{scene\} (\S+)$", text, re.MULTILINE)
