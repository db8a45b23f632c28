"""Random plans by the thousand or the million: `make plans`."""
