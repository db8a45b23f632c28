"""What ``robomech demo`` does: a pick and place with every part of the suite."""
