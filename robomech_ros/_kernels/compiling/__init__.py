"""Compilation of kernels, and the cache of its results."""
