"""Two curves in a plane, whose crossings are found."""
