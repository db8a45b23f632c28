"""What concerns processes: how nodes start, run, pause and end."""
