"""One model of all parallel robots: chains from a base to a platform, their loops closed."""
