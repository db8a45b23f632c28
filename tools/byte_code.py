"""Make the byte-code of what nodes and commands load; run by the Python of an environment.

usage: byte_code.py requirements_file folder_of_sources

Nodes start in half the time with it. They would make it themselves, several of one suite at once,
and anew at every start where PYTHONDONTWRITEBYTECODE is set. What only tests and builds load makes
its own when it is first imported.
"""

from __future__ import annotations

import compileall
import os
import re
import sys
from concurrent.futures import ProcessPoolExecutor
from importlib.metadata import Distribution, distributions
from pathlib import Path

# Required by others for what the suite does not do: fonts inside of PDF, highlighted source code,
# and building.
UNUSED = {"fonttools", "pygments", "setuptools"}
SHARE = 50


def normal(name: str) -> str:
    """Return a name as requirements are compared."""
    return re.sub(r"[-_.]+", "-", name).lower()


def named(requirement: str) -> str:
    """Return the name of a requirement without its versions."""
    return normal(re.match(r"[\w.-]+", requirement)[0])


def required(names: set[str], found: dict[str, Distribution]) -> list[Distribution]:
    """Return the installed distributions of these names and all that they require."""
    done: set[str] = set()
    while names:
        name = names.pop()
        if name in done or name in UNUSED or name not in found:
            continue
        done.add(name)
        for line in found[name].requires or ():
            if "extra ==" not in line:
                names.add(named(line))
    return [found[name] for name in sorted(done)]


def compile_files(files: list[str]) -> None:
    """Compile files; what packages bring for other Pythons need not be valid."""
    for file in files:
        compileall.compile_file(file, quiet=2)


def main(requirements: str, sources: str) -> None:
    """Compile in as many processes as there are cores."""
    found = {normal(each.metadata["Name"]): each for each in distributions()}
    lines = Path(requirements).read_text(encoding="utf-8").splitlines()
    names = {named(line) for line in lines if line and not line.startswith("#")}
    names |= {name for name in found if name.startswith("ros-")}
    files = [
        str(each.locate_file(file))
        for each in required(names, found)
        for file in each.files or ()
        if file.suffix == ".py" and "tests" not in file.parts
    ]
    files += [str(file) for file in Path(sources).rglob("*.py")]
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(compile_files, [files[i : i + SHARE] for i in range(0, len(files), SHARE)]))


if __name__ == "__main__":
    main(*sys.argv[1:])
