"""Report of oddities in a description that are no errors, once each."""

import logging
from functools import lru_cache


@lru_cache(maxsize=256)
def report_once(note: str) -> None:
    """Log a warning, unless the same one was among the last ones."""
    logging.getLogger(__name__).warning(note)
