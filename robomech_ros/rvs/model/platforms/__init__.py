"""Model of the view of a parallel robot, independent of any browser."""
