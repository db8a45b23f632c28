"""The parts of a notebook in MyST Markdown: its cells, assertions and exercises."""

import ast
import re
from typing import NamedTuple


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


def exercises(text: str) -> int:
    """Count the exercises of a notebook, each with a folded solution."""
    return text.count("\n<details>")
