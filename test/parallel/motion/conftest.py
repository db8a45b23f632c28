"""Shared fixtures of the tests of parallel robots' motions."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
