"""A virtual environment of this project: what was done in it, and how things get into it."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from pathlib import Path

import machine

ROOT = Path(__file__).resolve().parent.parent
REQUIREMENTS = ROOT / "requirements"
STOPPED = {-signal.SIGINT, -signal.SIGTERM, 128 + signal.SIGINT, 128 + signal.SIGTERM}


def say(text: str) -> None:
    """Print one line of progress."""
    print(f"setup: {text}", flush=True)


class SetUpError(Exception):
    """A step failed; the text says what to do."""


class SetUpStoppedError(SetUpError):
    """A step was ended by a signal."""


class Environment:
    """A virtual environment of this project and what has been done in it so far.

    `distribution` is the ROS distribution it carries, or empty; `extra` names a requirements file
    for what it offers beyond. Several threads may run commands at the same time.
    """

    def __init__(self, folder: Path, distribution: str, extra: str) -> None:
        self.folder = folder
        self.distribution = distribution
        self.extra = extra
        self.python = folder / "bin" / "python"
        self.uv = folder / "bin" / "uv"
        self.running: set[subprocess.Popen[str]] = set()
        self.stopped = threading.Event()
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

    def run(
        self, *command: str, quiet: bool = True, variables: Mapping[str, str] | None = None
    ) -> None:
        """Run a command of the environment; when that fails, show what it said and stop."""
        env = {**os.environ, **(variables or {})}
        env["PATH"] = f"{self.folder / 'bin'}{os.pathsep}{env.get('PATH', '')}"
        env["AMENT_PREFIX_PATH"] = env["CMAKE_PREFIX_PATH"] = str(self.folder)
        env["CXX"] = machine.compiler() or "c++"
        env["PIP_DISABLE_PIP_VERSION_CHECK"] = "1"
        # Those of a make that runs several of these would keep a build from using all cores.
        env.pop("MAKEFLAGS", None)
        pipe, both = (subprocess.PIPE, subprocess.STDOUT) if quiet else (None, None)
        try:
            process = subprocess.Popen(
                command, cwd=ROOT, env=env, stdout=pipe, stderr=both, text=True
            )
        except OSError as error:
            raise SetUpError(f"`{command[0]}` does not start: {error.strerror}") from error
        with process as it:
            self.running.add(it)
            if self.stopped.is_set():
                it.send_signal(signal.SIGINT)
            try:
                output, _ = it.communicate()
            except BaseException:
                it.kill()
                raise
            finally:
                self.running.discard(it)
        said = f"`{' '.join(command)[:120]} ...` ended with {it.returncode}"
        if it.returncode in STOPPED:
            raise SetUpStoppedError(said)
        if it.returncode:
            if quiet:
                lines = [x for x in output.splitlines() if not x.startswith("WARNING: ")]
                print("\n".join(lines[-60:]), file=sys.stderr)
            raise SetUpError(said)

    def run_python(self, *arguments: str, quiet: bool = True) -> None:
        """Run the Python of the environment as `run` does."""
        self.run(str(self.python), *arguments, quiet=quiet)

    def stop(self) -> None:
        """End what runs in other threads, and what waits or begins there."""
        self.stopped.set()
        for process in list(self.running):
            process.send_signal(signal.SIGINT)

    def pip(self, *arguments: str) -> None:
        """Install with pip, which never asks."""
        self.run_python("-m", "pip", "install", "--quiet", "--no-input", *arguments)

    def install(self, *arguments: str) -> None:
        """Install with uv where the environment has it, else, or where uv fails, with pip."""
        if self.uv.is_file():
            try:
                self.run(str(self.uv), "pip", "install", "--python", str(self.python), *arguments)
            except SetUpStoppedError:
                raise
            except SetUpError as error:
                say(f"{error}; pip takes its place")
            else:
                return
        self.pip(*arguments)

    def make(self) -> None:
        """Make an empty environment."""
        shutil.rmtree(self.folder, ignore_errors=True)
        self.run(sys.executable, "-m", "venv", str(self.folder))

    def fill(self) -> None:
        """Make the environment anew and install exactly the pinned wheels."""
        what = f"ROS 2 {self.distribution.capitalize()}" if self.distribution else "libraries"
        say(f"{self.folder.name}: {what} from wheels (once)")
        self.make()
        lists = [part for pins in self.pins for part in ("-r", str(pins))]
        try:
            self.pip("--only-binary", ":all:", "-r", str(REQUIREMENTS / "installer.txt"))
            uv = (str(self.uv), "pip", "install", "--python", str(self.python))
            self.run(*uv, "--no-deps", *lists, variables=index_of_pip(self.pip_settings()))
        except SetUpStoppedError:
            raise
        except SetUpError as error:
            say(f"{error}; pip takes its place, which is slower")
            # Whatever uv left half done is gone with it.
            self.make()
            self.pip("--no-deps", "--prefer-binary", "--no-compile", *lists)

    def pip_settings(self) -> str:
        """Return what pip is configured with, a line for each setting."""
        command = [str(self.python), "-m", "pip", "config", "list"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        return done.stdout


def index_of_pip(settings: str) -> dict[str, str]:
    """Return the variables that let uv ask the index that pip asks, where pip has one of its own.

    What the user says to uv itself is left alone.
    """
    found = {}
    for line in settings.splitlines():
        key, _, value = line.partition("=")
        found[key] = value.strip("'\"")
    variables = {"index-url": "UV_DEFAULT_INDEX", "cert": "SSL_CERT_FILE"}
    result = {}
    for setting, variable in variables.items():
        places = (f"{place}.{setting}" for place in (":env:", "install", "global"))
        value = next((found[place] for place in places if place in found), "")
        if value and variable not in os.environ:
            result[variable] = value
    return result
