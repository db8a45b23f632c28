"""Two curves in a plane, and their crossings."""
