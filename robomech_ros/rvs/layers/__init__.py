"""Layers of a page: each shows one subject, and brings its own folder of controls."""
