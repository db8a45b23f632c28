"""The mechanisms of all robots of the library."""

import sys
from pathlib import Path

import pytest

from robomech_ros.parallel import list_parallel, load_parallel

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(params=list_parallel())
def mechanism(request):
    """The model of a robot of the library."""
    return load_parallel(request.param).mechanism
