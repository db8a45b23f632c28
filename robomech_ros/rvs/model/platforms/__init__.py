"""What the view shows of a parallel robot; knows no browser."""
