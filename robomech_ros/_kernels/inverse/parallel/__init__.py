"""Arms with three parallel axes next to each other, in closed form."""
