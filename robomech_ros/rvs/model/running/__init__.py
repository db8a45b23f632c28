"""Running robots: their reports, and requests to them."""
