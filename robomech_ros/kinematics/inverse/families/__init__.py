"""Which solver an arm gets, by its geometry."""
