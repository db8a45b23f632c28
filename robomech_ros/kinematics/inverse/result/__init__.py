"""Result of inverse kinematics: status, branch names, and reasons if there is no solution."""
