"""Make the virtual environment that everything else runs in; what `make setup` calls.

Steps, each skipped while the digest of its inputs is unchanged:

1. environment: a fresh virtual environment with the pinned wheels (ROS 2 among them);
2. byte-code: that of these and of robomech_ros, since nodes start in half the time with it;
3. interfaces: robomech_interfaces built by its own CMakeLists.txt into a wheel and installed;
4. package: robomech_ros installed so that edits of the source take effect at once;
5. kernels: all numba kernels compiled into their cache;
6. with --compat: the message types of compat/, one package after another.

A step writes its digest when it is done and takes it away before it starts, so one that was
interrupted is done again. Only the standard library is used: this runs outside the environment.
"""

from __future__ import annotations

import argparse
import fcntl
import hashlib
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TextIO

import machine
import wire_types

ROOT = Path(__file__).resolve().parent.parent
REQUIREMENTS = ROOT / "requirements"
PEERS = "bench.txt"


def say(text: str) -> None:
    """Print one line of progress."""
    print(f"setup: {text}", flush=True)


class SetUpError(Exception):
    """A step failed; the text says what to do."""


def digest(paths: Iterable[Path], *more: str) -> str:
    """Return a digest of the names and contents of files and of further text."""
    sha = hashlib.sha256()
    for path in sorted(paths):
        sha.update(f"{path.relative_to(ROOT)}\0".encode())
        sha.update(path.read_bytes())
    for text in more:
        sha.update(f"\0{text}".encode())
    return sha.hexdigest()


class Environment:
    """A virtual environment of this project and what has been done in it so far.

    `distribution` is the ROS distribution it carries, or empty; `extra` names a requirements file
    for what it offers beyond.
    """

    def __init__(self, folder: Path, distribution: str, extra: str) -> None:
        self.folder = folder
        self.distribution = distribution
        self.extra = extra
        self.python = folder / "bin" / "python"
        self.pins = [REQUIREMENTS / "python.txt"]
        if distribution:
            self.pins.insert(0, REQUIREMENTS / f"ros-{distribution}.txt")

    def stamp(self, step: str) -> Path:
        """Return the file that holds the digest of a finished step."""
        return self.folder / ".done" / step

    def step(self, name: str, key: str, work: Callable[[], None]) -> None:
        """Do a step unless it was finished with the same digest."""
        stamp = self.stamp(name)
        if stamp.is_file() and stamp.read_text(encoding="utf-8") == key:
            return
        stamp.unlink(missing_ok=True)
        work()
        stamp.parent.mkdir(parents=True, exist_ok=True)
        stamp.write_text(key, encoding="utf-8")

    def succeeds(self, *command: str) -> bool:
        """Run the Python of the environment and say whether it ended with 0."""
        return not subprocess.run([str(self.python), *command], cwd=ROOT, check=False).returncode

    def run(self, *command: str, quiet: bool = True) -> None:
        """Run the Python of the environment; when that fails, show what it said and stop."""
        env = dict(os.environ)
        env["PATH"] = f"{self.folder / 'bin'}{os.pathsep}{env.get('PATH', '')}"
        env["AMENT_PREFIX_PATH"] = env["CMAKE_PREFIX_PATH"] = str(self.folder)
        env["CXX"] = machine.compiler() or "c++"
        env["PIP_DISABLE_PIP_VERSION_CHECK"] = "1"
        # Those of a make that runs several of these would keep a build from using all cores.
        env.pop("MAKEFLAGS", None)
        done = subprocess.run(
            [str(self.python), *command],
            cwd=ROOT,
            env=env,
            stdout=subprocess.PIPE if quiet else None,
            stderr=subprocess.STDOUT if quiet else None,
            text=True,
            check=False,
        )
        if done.returncode:
            if quiet:
                lines = [x for x in done.stdout.splitlines() if not x.startswith("WARNING: ")]
                print("\n".join(lines[-60:]), file=sys.stderr)
            raise SetUpError(f"`{' '.join(command)[:80]} ...` ended with {done.returncode}")

    def pip(self, *arguments: str) -> None:
        """Install with pip, which never asks."""
        self.run("-m", "pip", "install", "--quiet", "--no-input", *arguments)

    def fill(self) -> None:
        """Make the environment anew and install exactly the pinned wheels."""
        what = f"ROS 2 {self.distribution.capitalize()}" if self.distribution else "libraries"
        say(f"{self.folder.name}: {what} from wheels (once, 1 to 3 minutes)")
        shutil.rmtree(self.folder, ignore_errors=True)
        subprocess.run([sys.executable, "-m", "venv", str(self.folder)], check=True)
        lists = [part for pins in self.pins for part in ("-r", str(pins))]
        self.pip("--no-deps", "--prefer-binary", "--no-compile", *lists)

    def make_byte_code(self) -> None:
        """Make the byte code of all that was installed.

        Nodes would make it when they start: several of one suite at once, and each anew where
        PYTHONDONTWRITEBYTECODE is set.
        """
        (place,) = self.folder.glob("lib/python3*/site-packages")
        # What packages bring for their own tests need not be valid.
        self.succeeds("-m", "compileall", "-qq", "-j", "0", str(place), str(ROOT / "robomech_ros"))

    def add_extra(self) -> None:
        """Install what the environment offers beyond, without moving a pin.

        Of peers to compare with each is welcome, and none is needed.
        """
        say(f"{self.folder.name}: {self.extra}")
        options = ("--prefer-binary", "-c", str(REQUIREMENTS / "python.txt"))
        if self.extra != PEERS:
            self.pip(*options, "-r", str(REQUIREMENTS / self.extra))
            return
        for line in (REQUIREMENTS / self.extra).read_text(encoding="utf-8").splitlines():
            if line and not line.startswith("#"):
                try:
                    self.pip(*options, line)
                except SetUpError as error:
                    say(f"{line} is left out: {error}")

    def install_wheel(self, source: Path, key: str) -> None:
        """Build the wheel of a package of interfaces, or take one built before, and install it."""
        place = ROOT / "build" / "wheels" / key[:16]
        if not list(place.glob("*.whl")):
            say(f"{source.name}: compiling messages, services, actions (once, 1 to 3 minutes)")
            partial = place.with_name(f"{place.name}.partial")
            shutil.rmtree(partial, ignore_errors=True)
            options = ("--quiet", "--no-build-isolation", "--no-deps", "--no-cache-dir")
            self.run("-m", "pip", "wheel", *options, "-w", str(partial), str(source))
            shutil.rmtree(place, ignore_errors=True)
            partial.rename(place)
        wheels = map(str, place.glob("*.whl"))
        self.pip("--no-deps", "--no-index", "--force-reinstall", *wheels)

    def install_compat(self, source: Path, key: str) -> None:
        """Install a package of compat/, unless the environment has the real one."""
        if self.succeeds("-c", wire_types.IS_REAL, source.name):
            say(f"{source.name}: already installed, left as it is")
        else:
            self.install_wheel(source, key)

    def install_package(self) -> None:
        """Install robomech_ros as a link to the source, and its nodes where `ros2 run` looks."""
        say("robomech_ros: installed as a link to the source, edits take effect at once")
        options = ("--no-deps", "--no-index", "--no-build-isolation")
        self.pip(*options, "--editable", str(ROOT))
        nodes = self.folder / "lib" / "robomech_ros"
        nodes.mkdir(parents=True, exist_ok=True)
        for script in (self.folder / "bin").iterdir():
            if script.name == "robomech" or script.name.endswith("_node"):
                link = nodes / script.name
                link.unlink(missing_ok=True)
                link.symlink_to(Path("..", "..", "bin", script.name))

    def compile_kernels(self) -> None:
        """Compile all kernels, with progress shown."""
        say("numba kernels: compiling (once, under a minute)")
        self.run("-m", "robomech_ros.cli.main", "warmup", quiet=False)


def sources(folder: Path, pattern: str = "*") -> list[Path]:
    """Return the files of a folder, byte code left out."""
    return [p for p in folder.rglob(pattern) if p.is_file() and "__pycache__" not in p.parts]


def kernel_cache() -> Path:
    """Return the folder that compiled kernels are kept in, by the rule of robomech_ros._kernels."""
    if os.environ.get("ROBOMECH_CACHE_DIR"):
        return Path(os.environ["ROBOMECH_CACHE_DIR"])
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "robomech_ros"


def set_up(env: Environment, with_compat: bool) -> None:
    """Do every step whose inputs changed."""
    pins = digest(env.pins, sys.version, sys.base_prefix, str(env.folder))
    env.step("environment", pins, env.fill)
    env.step("byte-code", pins, env.make_byte_code)
    if env.extra:
        env.step("extra", digest([REQUIREMENTS / env.extra], pins), env.add_extra)
    if env.distribution:
        own = ROOT / "robomech_interfaces"
        built = digest([*sources(own), *env.pins], sys.version)
        env.step("interfaces", built, lambda: env.install_wheel(own, built))

    packaging = [ROOT / name for name in ("setup.py", "setup.cfg", "package.xml")]
    packaging += [ROOT / "robomech_ros" / "__init__.py", REQUIREMENTS / "core.in"]
    # Both work on what all environments share: the folder of the sources, and the kernels.
    with alone("sources", "another environment is being set up from these sources"):
        env.step("package", digest(packaging, str(ROOT)), env.install_package)
        if env.distribution:
            if not kernel_cache().is_dir():
                env.stamp("kernels").unlink(missing_ok=True)
            kernels = digest(sources(ROOT / "robomech_ros" / "_kernels", "*.py"), pins)
            env.step("kernels", digest([], kernels, str(kernel_cache())), env.compile_kernels)
    if with_compat:
        add_compat(env)


def add_compat(env: Environment) -> None:
    """Install the packages of compat/, each after those whose messages it contains."""
    shared = [wire_types.FOLDER / "wire_types.cmake", *env.pins]
    for source in wire_types.packages():
        shared += sources(source)
        key = digest(shared, sys.version)
        env.step(source.name, key, lambda s=source, k=key: env.install_compat(s, k))


def alone(name: str, otherwise: str) -> TextIO:
    """Wait until no other set-up holds the lock of this name, saying why; return the lock."""
    place = ROOT / "build"
    place.mkdir(exist_ok=True)
    lock = (place / f"{name.lstrip('.')}.lock").open("w", encoding="utf-8")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        say(f"{otherwise}; waiting for it")
        fcntl.flock(lock, fcntl.LOCK_EX)
    return lock


def main() -> int:
    """Check the machine, then set up one environment while no other process does."""
    parser = argparse.ArgumentParser(description="Make a virtual environment of this project.")
    parser.add_argument("folder", help="environment to make, below the root of the project")
    parser.add_argument("--distribution", default="", choices=("", "kilted", "jazzy"))
    parser.add_argument("--compat", action="store_true", help="add the message types of compat/")
    parser.add_argument("--extra", default="", help="a further file of requirements/")
    options = parser.parse_args()
    if options.compat and not options.distribution:
        parser.error("--compat needs --distribution")
    began = time.monotonic()
    problems = machine.missing()
    for problem in problems:
        say(problem)
    if problems:
        return 1
    try:
        with alone(options.folder, "another set-up of this environment is under way"):
            env = Environment(ROOT / options.folder, options.distribution, options.extra)
            set_up(env, options.compat)
    except (SetUpError, subprocess.CalledProcessError) as error:
        say(f"failed: {error}; mended, `make setup` goes on from here")
        return 1
    except KeyboardInterrupt:
        say("interrupted; `make setup` goes on from here")
        return 130
    say(f"{options.folder} is ready ({time.monotonic() - began:.1f} s)")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
