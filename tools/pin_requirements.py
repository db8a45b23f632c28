"""Write the pinned requirements of every supported Python and ROS distribution.

Run by hand when a version shall move:

    python3 tools/pin_requirements.py python3.10 python3.11 python3.12 python3.13

Each interpreter given makes a throw-away environment and asks pip what the `*.in` files of
requirements/ resolve to. The results are merged into `python.txt` (whatever is not ROS) and
`ros-<distribution>.txt`, with environment markers where Pythons differ.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from pathlib import Path

REQUIREMENTS = Path(__file__).resolve().parent.parent / "requirements"
DISTRIBUTIONS = ("kilted", "jazzy")
Pins = dict[str, dict[str, str]]  # name -> Python version -> pinned version


def resolve(python: str, distribution: str, place: Path) -> tuple[str, dict[str, str]]:
    """Return the version of an interpreter, and name -> version of what pip would install."""
    subprocess.run([python, "-m", "venv", "--clear", str(place)], check=True)
    report = place / "report.json"
    command = [str(place / "bin/python"), "-m", "pip", "--quiet", "install", "--dry-run"]
    command += ["--ignore-installed", "--report", str(report)]
    for name in (f"ros-{distribution}", "core", "develop"):
        command += ["-r", str(REQUIREMENTS / f"{name}.in")]
    subprocess.run(command, check=True)
    found = json.loads(report.read_text(encoding="utf-8"))
    pins = {
        entry["metadata"]["name"].lower().replace("_", "-"): entry["metadata"]["version"]
        for entry in found["install"]
    }
    return found["environment"]["python_version"], pins


def markers(versions: dict[str, str], pythons: list[str]) -> list[tuple[str, str]]:
    """Return (version, marker) for one package; the marker is empty where every Python agrees."""
    if len(set(versions.values())) == 1 and len(versions) == len(pythons):
        return [(versions[pythons[0]], "")]
    lines = []
    for version in dict.fromkeys(versions.values()):
        where = [f'python_version == "{p}"' for p in pythons if versions.get(p) == version]
        lines.append((version, " ; " + " or ".join(where)))
    return lines


def write(name: str, pins: Pins, pythons: list[str]) -> None:
    """Write one file of pins, sorted by name."""
    lines = [f"# Written by tools/pin_requirements.py for Python {', '.join(pythons)}.\n"]
    for package in sorted(pins):
        for version, marker in markers(pins[package], pythons):
            lines.append(f"{package}=={version}{marker}\n")
    (REQUIREMENTS / name).write_text("".join(lines), encoding="utf-8")


def main(interpreters: list[str]) -> int:
    """Resolve with every interpreter and write the files; refuse distributions that disagree."""
    if not interpreters:
        print(__doc__)
        return 2
    pythons: list[str] = []
    rest: dict[str, Pins] = {}
    with tempfile.TemporaryDirectory() as place:
        for distribution in DISTRIBUTIONS:
            ros: Pins = {}
            rest[distribution] = {}
            for interpreter in interpreters:
                python, found = resolve(interpreter, distribution, Path(place) / "venv")
                pythons = list(dict.fromkeys([*pythons, python]))
                for name, version in found.items():
                    table = ros if name.startswith("ros-") else rest[distribution]
                    table.setdefault(name, {})[python] = version
            write(f"ros-{distribution}.txt", ros, pythons)
    first = rest[DISTRIBUTIONS[0]]
    for distribution, others in rest.items():
        for name in sorted({*first, *others}):
            if first.get(name) != others.get(name):
                print(f"{name}: {first.get(name)}, {distribution}: {others.get(name)}")
                return 1
    write("python.txt", first, pythons)
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
