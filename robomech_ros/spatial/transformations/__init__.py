"""Linear transformations, changes of frame, and what no change of frame alters."""
