"""Helpers of these tests, beside those of the folder above."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
