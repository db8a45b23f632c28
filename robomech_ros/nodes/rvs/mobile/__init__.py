"""Mobile robots: reception of their states, and twist commands."""
