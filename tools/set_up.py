"""Make the virtual environment that everything else runs in; what `make setup` calls.

Steps, each skipped while the digest of its inputs is unchanged:

1. environment: a fresh virtual environment with the pinned wheels (ROS 2 among them);
2. byte-code: that of what nodes load, since they start in half the time with it;
3. package: robomech_ros installed so that edits of the source take effect at once;
4. interfaces: robomech_interfaces built by its own CMakeLists.txt into a wheel and installed;
5. the message types of compat/, one package after another;
6. kernels: all numba kernels compiled into their cache, at the same time as 3 to 5.

`--for-demo ROBOT` leaves out step 5, and the kernels that the demonstration of this robot does not
use: they are compiled at their first use.

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
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TextIO

import machine
import wire_types
from environment import REQUIREMENTS, ROOT, Environment, SetUpError, SetUpStoppedError, say

PEERS = "bench.txt"
ROOT_PACKAGE = "robomech_ros"


def digest(paths: Iterable[Path], *more: str) -> str:
    """Return a digest of the names and contents of files and of further text."""
    sha = hashlib.sha256()
    for path in sorted(paths):
        sha.update(f"{path.relative_to(ROOT)}\0".encode())
        sha.update(path.read_bytes())
    for text in more:
        sha.update(f"\0{text}".encode())
    return sha.hexdigest()


def make_byte_code(env: Environment) -> None:
    """Make the byte-code of what nodes load."""
    tool = ROOT / "tools" / "byte_code.py"
    env.run_python(str(tool), str(REQUIREMENTS / "core.in"), str(ROOT / "robomech_ros"))


def add_extra(env: Environment) -> None:
    """Install what the environment offers beyond, without moving a pin.

    Of peers to compare with each is welcome, and none is needed.
    """
    say(f"{env.folder.name}: {env.extra}")
    options = ("--prefer-binary", "-c", str(REQUIREMENTS / "python.txt"))
    if env.extra != PEERS:
        env.pip(*options, "-r", str(REQUIREMENTS / env.extra))
        return
    for line in (REQUIREMENTS / env.extra).read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            try:
                env.pip(*options, line)
            except SetUpError as error:
                say(f"{line} is left out: {error}")


def install_wheel(env: Environment, source: Path, key: str) -> None:
    """Build the wheel of a package of interfaces, or take one built before, and install it."""
    place = ROOT / "build" / "wheels" / key[:16]
    if not list(place.glob("*.whl")):
        say(f"{source.name}: compiling messages, services, actions (once)")
        partial = place.with_name(f"{place.name}.partial")
        shutil.rmtree(partial, ignore_errors=True)
        options = ("--quiet", "--no-build-isolation", "--no-deps", "--no-cache-dir")
        env.run_python("-m", "pip", "wheel", *options, "-w", str(partial), str(source))
        shutil.rmtree(place, ignore_errors=True)
        partial.rename(place)
    wheels = map(str, place.glob("*.whl"))
    env.install("--no-deps", "--no-index", "--force-reinstall", *wheels)


def install_compat(env: Environment, source: Path, key: str) -> None:
    """Install a package of compat/, unless the environment has the real one."""
    if env.succeeds("-c", wire_types.IS_REAL, source.name):
        say(f"{source.name}: already installed, left as it is")
    else:
        install_wheel(env, source, key)


def install_package(env: Environment) -> None:
    """Install robomech_ros as a link to the source, and all that `ros2 run` looks for."""
    say("robomech_ros: installed as a link to the source, edits take effect at once")
    options = ("--no-deps", "--no-index", "--no-build-isolation")
    env.install(*options, "--editable", str(ROOT))
    nodes = env.folder / "lib" / ROOT_PACKAGE
    for script in (env.folder / "bin").iterdir():
        if script.name == "robomech" or script.name.endswith("_node"):
            link_to(Path("..", "..", "bin", script.name), nodes / script.name)
    share = env.folder / "share"
    link_to(
        ROOT / "resource" / ROOT_PACKAGE,
        share / "ament_index" / "resource_index" / "packages" / ROOT_PACKAGE,
    )
    for name in ("package.xml", "config"):
        link_to(ROOT / name, share / ROOT_PACKAGE / name)


def link_to(target: Path, link: Path) -> None:
    """Make a link, in place of one that is there."""
    link.parent.mkdir(parents=True, exist_ok=True)
    link.unlink(missing_ok=True)
    link.symlink_to(target)


def compile_kernels(env: Environment, robot: str) -> None:
    """Compile all kernels, or those for the demonstration of a robot, with progress shown."""
    say("numba kernels: compiling (once)")
    options = ("--robot", robot) if robot else ()
    env.run_python("-m", "robomech_ros.cli.main", "warmup", *options, quiet=False)


def sources(folder: Path, pattern: str = "*") -> list[Path]:
    """Return the files of a folder, byte code left out."""
    return [p for p in folder.rglob(pattern) if p.is_file() and "__pycache__" not in p.parts]


def kernel_cache() -> Path:
    """Return the folder that compiled kernels are kept in, by the rule of robomech_ros._kernels."""
    if os.environ.get("ROBOMECH_CACHE_DIR"):
        return Path(os.environ["ROBOMECH_CACHE_DIR"])
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base) / "robomech_ros"


def set_up(env: Environment, with_compat: bool, robot: str) -> None:
    """Do every step whose inputs changed; for a robot, with no more kernels than it needs."""
    pins = digest(env.pins, sys.version, sys.base_prefix, str(env.folder))
    env.step("environment", pins, env.fill)
    env.step("byte-code", pins, lambda: make_byte_code(env))
    if env.extra:
        env.step("extra", digest([REQUIREMENTS / env.extra], pins), lambda: add_extra(env))
    together: list[Callable[[], None]] = [lambda: add_packages(env, with_compat)]
    if env.distribution:
        together.append(lambda: add_kernels(env, pins, robot))
    at_once(env, together)


def at_once(env: Environment, works: list[Callable[[], None]]) -> None:
    """Do several things at the same time; all end before their failures are raised."""
    failures: list[Exception] = []
    with ThreadPoolExecutor(len(works)) as pool:
        try:
            for future in [pool.submit(work) for work in works]:
                try:
                    future.result()
                except (SetUpError, subprocess.CalledProcessError) as error:
                    failures.append(error)
        except KeyboardInterrupt:
            env.stop()
            raise
    if len(failures) > 1:
        raise SetUpError("; ".join(map(str, failures)))
    if failures:
        raise failures[0]


def add_kernels(env: Environment, pins: str, robot: str) -> None:
    """Compile the kernels, which all environments share."""
    with alone(env, "kernels", "kernels are being compiled for another environment"):
        name = "demonstration" if robot else "kernels"
        if not kernel_cache().is_dir():
            env.stamp(name).unlink(missing_ok=True)
        kernels = digest(sources(ROOT / "robomech_ros" / "_kernels", "*.py"), pins)
        key = digest([], kernels, str(kernel_cache()), robot)
        env.step(name, key, lambda: compile_kernels(env, robot))


def add_packages(env: Environment, with_compat: bool) -> None:
    """Install our own packages."""
    packaging = [ROOT / name for name in ("setup.py", "setup.cfg", "package.xml")]
    packaging += [ROOT / "robomech_ros" / "__init__.py", REQUIREMENTS / "core.in"]
    packaging.append(Path(__file__).resolve())
    # The build works in the folder of the sources.
    with alone(env, "sources", "another environment is being set up from these sources"):
        env.step("package", digest(packaging, str(ROOT)), lambda: install_package(env))
    if env.distribution:
        own = ROOT / "robomech_interfaces"
        built = digest([*sources(own), *env.pins], sys.version)
        env.step("interfaces", built, lambda: install_wheel(env, own, built))
    if with_compat:
        add_compat(env)


def add_compat(env: Environment) -> None:
    """Install the packages of compat/, each after those whose messages it contains."""
    shared = [wire_types.FOLDER / "wire_types.cmake", *env.pins]
    for source in wire_types.packages():
        shared += sources(source)
        key = digest(shared, sys.version)
        env.step(source.name, key, lambda s=source, k=key: install_compat(env, s, k))


def alone(env: Environment, name: str, otherwise: str) -> TextIO:
    """Wait until no other set-up holds the lock of this name, saying why; return the lock."""
    place = ROOT / "build"
    place.mkdir(exist_ok=True)
    lock = (place / f"{name.lstrip('.')}.lock").open("w", encoding="utf-8")
    if taken(lock):
        return lock
    say(f"{otherwise}; waiting for it")
    # A thread that waits in the kernel would not notice that it is to stop.
    while not env.stopped.wait(0.2):
        if taken(lock):
            return lock
    lock.close()
    raise SetUpStoppedError(f"the wait for the lock `{name}` was interrupted")


def taken(lock: TextIO) -> bool:
    """Take a lock unless somebody else holds it."""
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def main() -> int:
    """Check the machine, then set up one environment while no other process does."""
    parser = argparse.ArgumentParser(description="Make a virtual environment of this project.")
    parser.add_argument("folder", help="environment to make, below the root of the project")
    parser.add_argument("--distribution", default="", choices=("", "kilted", "jazzy"))
    parser.add_argument(
        "--for-demo",
        metavar="ROBOT",
        default="",
        help="only what the demonstration of this robot uses",
    )
    parser.add_argument("--extra", default="", help="a further file of requirements/")
    options = parser.parse_args()
    began = time.monotonic()
    problems = machine.missing()
    for problem in problems:
        say(problem)
    if problems:
        return 1
    try:
        env = Environment(ROOT / options.folder, options.distribution, options.extra)
        with alone(env, options.folder, "another set-up of this environment is under way"):
            compat = bool(env.distribution) and not options.for_demo
            set_up(env, compat, options.for_demo)
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
