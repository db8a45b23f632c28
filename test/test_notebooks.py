"""The notebooks in doc/notebooks: all cells run, and the index says what each contains."""

import ast
import re
from pathlib import Path
from typing import NamedTuple

import pytest

matplotlib = pytest.importorskip("matplotlib")

FOLDER = Path(__file__).resolve().parent.parent / "doc" / "notebooks"
NOTEBOOKS = sorted(path for path in FOLDER.glob("*.md") if path.stem != "index")


class Cell(NamedTuple):
    """A code cell: the number of lines above its code, and the code."""

    above: int
    source: str


def cells(text: str) -> list[Cell]:
    """Return the code cells of a notebook."""
    return [
        Cell(text.count("\n", 0, found.start(1)), found[1])
        for found in re.finditer(r"^```\{code-cell\}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    ]


def assertions(text: str) -> int:
    """Count the assertions in the code cells of a text."""
    trees = [ast.parse(cell.source) for cell in cells(text)]
    return sum(isinstance(node, ast.Assert) for tree in trees for node in ast.walk(tree))


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


def test_the_index_lists_every_notebook_with_its_assertions_and_exercises():
    rows = re.findall(
        r"^\| .+? \| \[.+?\]\((\w+)\.md\) \| .+? \| (\d+) \| (\d) \|$",
        (FOLDER / "index.md").read_text("utf-8"),
        re.MULTILINE,
    )
    counted = []
    for page in NOTEBOOKS:
        text = page.read_text("utf-8")
        counted.append((page.stem, str(assertions(text)), str(text.count("\n<details>"))))
    assert sorted(rows) == counted
