"""What a page has for a robot that runs: news of it, and buttons that are held."""
