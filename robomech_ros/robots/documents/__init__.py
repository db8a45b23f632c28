"""Documents of robots: found, read within bounds, and checked entry by entry."""
