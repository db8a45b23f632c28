"""Pages of files are given back, and what was in them is there again when it is needed."""

import subprocess
import sys

import pytest

PROGRAM = r"""
import re
from pathlib import Path
import llvmlite.binding as llvm
import numpy as np
from robomech_ros.nodes.process.clean_pages import release_clean_pages

def resident(kind):
    status = Path("/proc/self/status").read_text()
    return int(re.search(rf"^{kind}:\s+([0-9]+) kB", status, re.M)[1])

def works():
    module = llvm.parse_assembly("define i32 @f() { ret i32 7 }")
    return str(module), float(np.linalg.solve(np.diag([2.0, 4.0]), [2.0, 8.0]).sum())

before, files, own = works(), resident("RssFile"), resident("RssAnon")
assert release_clean_pages() > 0
assert resident("RssFile") < 0.6 * files, (resident("RssFile"), files)
assert resident("RssAnon") > 0.9 * own
assert works() == before
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the kernel of Linux tells of pages")
def test_pages_of_files_are_given_back_and_read_again():
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
