"""The workspace: its boundary, sections, and the orientations at a point."""
