"""Declarations of the two packages, compared with their contents."""

from __future__ import annotations

import ast
import importlib.metadata
import re
import sys
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
INTERFACES = ROOT / "robomech_interfaces"
DEFINITIONS = sorted(
    path for path in INTERFACES.glob("*/*") if path.suffix in (".msg", ".srv", ".action")
)
# Import name -> rosdep key, where they differ.
ROSDEP = {
    "contourpy": "python3-matplotlib",  # which needs it
    "llvmlite": "python3-numba",  # which it is a part of
    "lxml": "python3-lxml",
    "matplotlib": "python3-matplotlib",
    "numba": "python3-numba",
    "numpy": "python3-numpy",
    "rich": "python3-rich",
    "scipy": "python3-scipy",
    "yaml": "python3-yaml",
}
# Import name -> name in the package index, where they differ.
INDEX = {"llvmlite": "numba", "yaml": "pyyaml"}
# Imported only where it is installed, or without a rosdep key (README.md says how it is installed).
OPTIONAL = {"control_msgs", "distributed", "moveit_msgs", "sympy", "tf2_msgs", "tf2_ros"}
# The conic solver of hands.
OPTIONAL |= {"clarabel"}
# Distances and sampling planners of collision.
OPTIONAL |= {"coal", "ompl"}
# The browser view, which brings the others.
OPTIONAL |= {"viser", "msgspec", "trimesh", "websockets"}
NO_ROSDEP_KEY = {"ruckig"}


def declared(package: Path, *kinds: str) -> set[str]:
    """Return the dependencies that a package.xml declares."""
    root = ET.parse(package / "package.xml").getroot()
    return {element.text or "" for kind in kinds for element in root.findall(kind)}


def imported() -> set[str]:
    """Return the top-level modules outside the standard library that the package imports."""
    names = set()
    for path in (ROOT / "robomech_ros").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
                names.add(node.module.split(".")[0])
    return names - set(sys.stdlib_module_names) - {"robomech_ros"}


def test_package_xml_declares_what_is_imported():
    needed = {ROSDEP.get(name, name) for name in imported() - OPTIONAL - NO_ROSDEP_KEY}
    assert needed <= declared(ROOT, "depend", "exec_depend")


def test_requirements_declare_what_is_imported():
    text = (ROOT / "requirements" / "core.in").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    listed = {line.split("<")[0] for line in lines}
    pip = {name for name in imported() if name in {*ROSDEP, *NO_ROSDEP_KEY}}
    assert {INDEX.get(name, name) for name in pip} == listed


def test_every_pin_is_exact_and_every_wish_is_pinned():
    folder = ROOT / "requirements"
    pin = re.compile(r'^([a-z0-9-]+)==[0-9][\w.]*( ; python_version == "3\.\d+"( or .*)?)?$')
    for pins, wishes in {
        "python.txt": ("core.in", "develop.in"),
        "ros-kilted.txt": ("ros-kilted.in",),
        "ros-jazzy.txt": ("ros-jazzy.in",),
        "installer.txt": (),
    }.items():
        lines = (folder / pins).read_text(encoding="utf-8").splitlines()
        lines = [line for line in lines if not line.startswith("#")]
        assert lines and all(pin.match(line) for line in lines), pins
        names = {line.split("==")[0] for line in lines}
        for wish in wishes:
            for line in (folder / wish).read_text(encoding="utf-8").splitlines():
                name = re.split(r"[<>=\[ ]", line)[0].lower().replace("_", "-")
                if name and not name.startswith("#") and name != "catkin-pkg":
                    assert name in names, f"{name} of {wish} is not pinned in {pins}"


def test_versions_agree():
    package = importlib.metadata.version("robomech_ros")
    for folder in (ROOT, INTERFACES):
        assert ET.parse(folder / "package.xml").getroot().findtext("version") == package
    text = (INTERFACES / "pyproject.toml").read_text(encoding="utf-8")
    assert f'version = "{package}"' in text


def test_entry_points_lead_to_functions():
    points = importlib.metadata.entry_points(group="console_scripts")
    ours = [point for point in points if point.value.startswith("robomech_ros.")]
    assert len(ours) == 13
    for point in ours:
        assert callable(point.load()), point
        for folder in ("bin", "lib/robomech_ros"):
            assert (Path(sys.prefix) / folder / point.name).exists(), point


def test_importing_the_package_costs_nothing(output_of, shell_environment, tmp_path):
    code = "import sys; before = set(sys.modules); import robomech_ros; print(*sys.modules)"
    modules = output_of(sys.executable, "-c", code, env=shell_environment(), cwd=tmp_path).split()
    heavy = {"rclpy", "numba", "numpy", "scipy", "yaml", "matplotlib", "ruckig"}
    assert not heavy & set(modules)


def test_a_wheel_holds_code_robots_and_markers(output_of, shell_environment, tmp_path):
    options = ("--no-deps", "--no-index", "--no-build-isolation", "--quiet")
    source = tmp_path / "source"
    source.mkdir()
    for name in ("setup.py", "setup.cfg", "pyproject.toml", "package.xml", "README.md", "resource"):
        (source / name).symlink_to(ROOT / name)
    for name in ("config", "requirements", "robomech_ros"):
        (source / name).symlink_to(ROOT / name)
    pip = (sys.executable, "-m", "pip", "wheel", *options, "-w", tmp_path, ".")
    output_of(*pip, env=shell_environment(), cwd=source)
    (wheel,) = tmp_path.glob("*.whl")
    held = zipfile.ZipFile(wheel).namelist()
    modules = {str(path.relative_to(ROOT)) for path in (ROOT / "robomech_ros").rglob("*.py")}
    assert modules | {"robomech_ros/py.typed"} <= set(held)
    data = {name.split(".data/data/")[-1] for name in held if ".data/data/" in name}
    config = {f"share/robomech_ros/{p.relative_to(ROOT)}" for p in files_below(ROOT / "config")}
    assert config <= data
    assert "share/ament_index/resource_index/packages/robomech_ros" in data


def files_below(folder: Path) -> list[Path]:
    """Return all files of a folder."""
    return [path for path in folder.rglob("*") if path.is_file()]


@pytest.mark.parametrize("path", DEFINITIONS, ids=lambda path: path.name)
def test_every_field_is_explained(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("#"), "says first what it is for"
    for before, line in zip(["", *lines], lines, strict=False):
        if line and not line.startswith(("#", "---")):
            assert "#" in line or before.startswith("#"), f"not explained: {line}"


@pytest.mark.parametrize("path", DEFINITIONS, ids=lambda path: path.name)
def test_every_definition_is_built_and_answers_end_alike(path):
    cmake = (INTERFACES / "CMakeLists.txt").read_text(encoding="utf-8")
    assert f"  {path.relative_to(INTERFACES)}\n" in cmake
    parts = re.split(r"^---$", path.read_text(encoding="utf-8"), flags=re.MULTILINE)
    if len(parts) > 1:
        fields = [line for line in parts[1].splitlines() if line and not line.startswith("#")]
        assert fields[-2:] == ["uint16 error_code", "string error_msg"]
