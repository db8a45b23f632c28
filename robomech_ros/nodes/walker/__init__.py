"""The node `walker`: a walking machine that follows commands of its twist."""
