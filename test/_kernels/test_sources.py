"""Stale kernels never load: the digest of a module covers all that it is made from."""

import ast
import importlib
import os
import re
import subprocess
import sys

import pytest

from robomech_ros._kernels.chain.serial import forward_one
from robomech_ros._kernels.compiling.sources import PACKAGE, KernelSources, sources

FILES = {
    "__init__.py": "",
    "tolerances.py": "NEAR = 1e-9\nFAR = 1.0\n",
    "algebra/__init__.py": "",
    "algebra/roots.py": "def root(x): return x\n",
    "algebra/sums.py": "def total(x): return x\n",
    "inverse/__init__.py": "",
    "inverse/layout.py": "FIRST = 0\n",
    "inverse/arm.py": "from k.algebra.roots import root\nfrom k.tolerances import (\n NEAR,\n)\n",
    "inverse/hand.py": "from k.inverse import layout as at\nfrom k import tolerances\n",
    "inverse/all.py": "import k.inverse.arm\nfrom k.inverse import (\n    hand,\n    layout,\n)\n",
    "other/__init__.py": "",
    "other/arm.py": "import math\n",
}
# What is recompiled after a change of a module, besides itself.
DEPENDANTS = {
    "algebra/roots.py": {"inverse.arm", "inverse.all"},
    "algebra/sums.py": set(),
    "tolerances.py": {"inverse.arm", "inverse.hand", "inverse.all"},
    "inverse/layout.py": {"inverse.hand", "inverse.all"},
    "inverse/all.py": set(),
    "other/arm.py": set(),
}


@pytest.fixture
def folder(tmp_path):
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def digests(folder):
    found = KernelSources(folder, "k")
    return {name: found.digest(name) for name in found.modules()}


@pytest.mark.parametrize("name", DEPENDANTS)
def test_a_change_concerns_a_module_and_its_dependants(folder, name):
    before = digests(folder)
    (folder / name).write_text(FILES[name] + "X = 1\n")
    after = digests(folder)
    changed = {module for module in before if before[module] != after[module]}
    assert changed == {name[:-3].replace("/", "."), *DEPENDANTS[name]}


def test_what_a_package_runs_concerns_all_that_is_imported_from_it(folder):
    before = digests(folder)
    (folder / "inverse/__init__.py").write_text("X = 1\n")
    after = digests(folder)
    changed = {module for module in before if before[module] != after[module]}
    assert changed == {"inverse.hand", "inverse.all"}


def test_equal_modules_of_two_folders_have_different_digests(folder):
    (folder / "inverse/arm.py").write_text(FILES["other/arm.py"])
    assert digests(folder)["inverse.arm"] != digests(folder)["other.arm"]


def imports(module):
    """Name what a module imports, as Python itself reads it."""
    for node in ast.walk(ast.parse(sources().path(module).read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            package = [PACKAGE, *module.split(".")][: -node.level or None] if node.level else []
            base = ".".join([*package, *filter(None, [node.module])])
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


def test_no_import_of_a_kernel_is_missed():
    modules = sources().modules()
    own = {f"{PACKAGE}.{module}": module for module in modules}
    for module in modules:
        imported = {own[name] for name in imports(module) if name in own}
        assert imported <= sources().imported(module), module


def test_every_kernel_depends_on_how_it_is_compiled():
    for module in ("chain.serial", "inverse.one_pose", "timing.optimal"):
        assert "compiling.jit" in sources().imported(module)
    assert "compiling.sources" in sources().imported("compiling.cache")


def test_the_kernels_in_use_are_those_of_the_sources():
    digest = sources().digest("chain.serial")
    kept = re.compile(rf"serial\.forward_one-chain\.serial-\d+-{digest}\.py\d+\w*\.nbi")
    assert any(kept.fullmatch(name) for name in os.listdir(forward_one.stats.cache_path))


KERNELS = {
    "values/__init__.py": "",
    "values/tolerances.py": "STEP = 1.0\n",
    "values/callee.py": """
from robomech_ros._kernels.compiling.jit import lean
from robomech_ros._kernels.values.tolerances import STEP

@lean
def add(x):
    return x + STEP
""",
    "here/__init__.py": "",
    "here/arm.py": """
from robomech_ros._kernels.compiling.jit import kernel
from robomech_ros._kernels.compiling.types import f8
from robomech_ros._kernels.values.callee import add

@kernel(f8(f8))
def solve(x):
    return add(x)
""",
    "there/__init__.py": "",
    "there/arm.py": """
from robomech_ros._kernels.compiling.jit import kernel
from robomech_ros._kernels.compiling.types import f8


@kernel(f8(f8))
def solve(x):
    return -x
""",
}
PROGRAM = """
import robomech_ros._kernels
robomech_ros._kernels.__path__.append({folder!r})
from robomech_ros._kernels.compiling import sources as found
own = found.KernelSources.__init__
def with_those_of_the_test(self, folder, package):
    own(self, folder, package)
    self._files.update(found._modules(found.Path({folder!r}), ""))
found.KernelSources.__init__ = with_those_of_the_test
from robomech_ros._kernels.here.arm import solve as first
from robomech_ros._kernels.there.arm import solve as second
print(first(2.0), second(2.0), *[sum(f.stats.cache_hits.values()) for f in (first, second)])
"""


@pytest.fixture
def answers(tmp_path):
    """Return a function that writes kernels and calls them in a process of its own."""
    folder = tmp_path / "kernels"
    for name, text in KERNELS.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)

    def run(name="", old="", new=""):
        if name:
            (folder / name).write_text(KERNELS[name].replace(old, new))
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM.format(folder=str(folder))],
            env={**os.environ, "ROBOMECH_CACHE_DIR": str(tmp_path / "cache")},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout.split()

    return run


@pytest.mark.slow
def test_kernels_that_changed_are_compiled_and_others_loaded(answers):
    """Numbers, then whether the kernel came from the cache: of one with callees, and one without.

    Both are called ``solve`` and stand on the same line of equally named files.
    """
    assert answers() == ["3.0", "-2.0", "0", "0"]
    assert answers() == ["3.0", "-2.0", "1", "1"]
    assert answers("values/callee.py", "x + STEP", "x * STEP + 5.0") == ["7.0", "-2.0", "0", "1"]
    assert answers("values/tolerances.py", "1.0", "2.0") == ["9.0", "-2.0", "0", "1"]
    assert answers("there/arm.py", "-x", "-2.0 * x") == ["9.0", "-4.0", "1", "0"]
    assert answers("values/callee.py", "x + STEP", "x + STEP") == ["4.0", "-4.0", "0", "1"]


def test_a_kernel_module_can_be_found_by_its_name():
    for module in sources().modules():
        assert importlib.util.find_spec(f"{PACKAGE}.{module}").origin == str(sources().path(module))
