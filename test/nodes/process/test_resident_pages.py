"""Pages of files are given back and read again when needed; the heap is in huge pages."""

import subprocess
import sys

import pytest

PROGRAM = r"""
import re
from pathlib import Path
import llvmlite.binding as llvm
import numpy as np
from robomech_ros.nodes.process.memory import settle_pages

def resident(kind):
    status = Path("/proc/self/status").read_text()
    return int(re.search(rf"^{kind}:\s+([0-9]+) kB", status, re.M)[1])

def works():
    module = llvm.parse_assembly("define i32 @f() { ret i32 7 }")
    return str(module), float(np.linalg.solve(np.diag([2.0, 4.0]), [2.0, 8.0]).sum())

before, files, own = works(), resident("RssFile"), resident("RssAnon")
assert settle_pages() > 0
assert resident("RssFile") < 0.6 * files, (resident("RssFile"), files)
assert resident("RssAnon") > 0.9 * own
assert works() == before
"""


HEAP = r"""
import ctypes, mmap, re
from pathlib import Path
import numpy as np
from robomech_ros.nodes.process import memory

def huge():
    smaps = Path("/proc/self/smaps").read_text()
    return sum(map(int, re.findall(r"^AnonHugePages: +([0-9]+) kB", smaps, re.M)))

system = ctypes.CDLL(None)
system.madvise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
probe = mmap.mmap(-1, 8 * memory._HUGE_PAGE, flags=mmap.MAP_PRIVATE)
probe.write(b"1" * len(probe))
start = ctypes.addressof(ctypes.c_char.from_buffer(probe))
page = -(-start // memory._HUGE_PAGE) * memory._HUGE_PAGE
able = system.madvise(page, memory._HUGE_PAGE, memory._MADV_COLLAPSE) == 0
values = [float(k) for k in range(1_000_000)]
before = huge()
memory.settle_pages()
assert huge() > before + 10_000 or not able, (before, huge())
assert sum(values) == 499_999_500_000.0
print("huge pages" if able else "none here")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the kernel of Linux tells of pages")
def test_pages_of_files_are_given_back_and_read_again():
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="the kernel of Linux has huge pages")
def test_the_heap_is_gathered_in_huge_pages():
    done = subprocess.run([sys.executable, "-c", HEAP], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    if "none here" in done.stdout:
        pytest.skip("this kernel has no huge pages on demand (Linux 6.1)")
