"""What the view shows of a robot; knows no browser."""
