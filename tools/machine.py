"""Checks what the machine must bring, and names the command that installs what is missing."""

from __future__ import annotations

import importlib.util
import os
import platform
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

PYTHON = f"python{sys.version_info.major}.{sys.version_info.minor}"
GLIBC = (2, 28)

# What is needed -> package by package manager; {python} is the interpreter's own name.
PACKAGES = {
    "compiler": {"apt-get": "g++", "dnf": "gcc-c++", "pacman": "gcc", "zypper": "gcc-c++"},
    "venv": {
        "apt-get": "{python}-venv",
        "dnf": "{python}",
        "pacman": "python",
        "zypper": "{python}",
    },
    "headers": {
        "apt-get": "{python}-dev",
        "dnf": "{python}-devel",
        "pacman": "python",
        "zypper": "{python}-devel",
    },
}
INSTALL = {
    "apt-get": "sudo apt-get install {}",
    "dnf": "sudo dnf install {}",
    "pacman": "sudo pacman -S {}",
    "zypper": "sudo zypper install {}",
}


def install_command(what: str) -> str:
    """Return the command that installs one of PACKAGES on this machine."""
    for manager, template in INSTALL.items():
        if shutil.which(manager):
            return template.format(PACKAGES[what][manager].format(python=PYTHON))
    return f"install {PACKAGES[what]['apt-get'].format(python=PYTHON)} with your package manager"


def works(command: str) -> bool:
    """Say whether a compiler turns a C++17 source into an object."""
    source = "#include <optional>\nint main() { return std::optional<int>(0).value(); }\n"
    arguments = [*command.split(), "-std=c++17", "-x", "c++", "-c", "-o", os.devnull, "-"]
    try:
        done = subprocess.run(arguments, input=source.encode(), capture_output=True, check=False)
    except OSError:
        return False
    return done.returncode == 0


def compiler() -> str | None:
    """Return the C++ compiler to be used: $CXX, or the first that works."""
    if os.environ.get("CXX"):
        return os.environ["CXX"] if works(os.environ["CXX"]) else None
    return next((name for name in ("c++", "g++", "clang++") if works(name)), None)


def wheels_fit() -> list[str]:
    """Return why the wheels of ROS 2 cannot run on this machine; empty where they can."""
    if sys.platform != "linux" or platform.machine() not in ("x86_64", "AMD64"):
        return [
            f"the wheels of ROS 2 exist for Linux on x86-64 only, this is {sys.platform} on "
            f"{platform.machine()}: build with colcon on a ROS distribution instead (README.md)"
        ]
    library, version = platform.libc_ver()
    if library != "glibc" or tuple(int(part) for part in version.split(".")[:2]) < GLIBC:
        found = f"{library} {version}".strip() or "another C library"
        return [
            f"the wheels of ROS 2 need glibc {GLIBC[0]}.{GLIBC[1]} or newer, this is {found}: "
            "build with colcon on a ROS distribution instead (README.md)"
        ]
    return []


def missing() -> list[str]:
    """Return one line for everything that is missing, each with the command that mends it."""
    lines = wheels_fit()
    if importlib.util.find_spec("venv") is None or importlib.util.find_spec("ensurepip") is None:
        lines.append(f"{PYTHON} lacks venv or ensurepip: {install_command('venv')}")
    if not (Path(sysconfig.get_paths()["include"]) / "Python.h").is_file():
        lines.append(f"{PYTHON} lacks its C headers (Python.h): {install_command('headers')}")
    if compiler() is None:
        named = os.environ.get("CXX")
        what = f"CXX={named} does not compile C++17" if named else "no C++17 compiler"
        lines.append(f"{what}: {install_command('compiler')}")
    return lines
