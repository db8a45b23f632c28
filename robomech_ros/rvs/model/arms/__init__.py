"""The arm that is moved, its posture and its Denavit-Hartenberg table."""
