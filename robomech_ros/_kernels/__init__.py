"""Compiled kernels: arrays in, arrays and an integer status out.

Importing a kernel module compiles its kernels, or loads them from the cache that
:mod:`robomech_ros._kernels.compiling.jit` keeps.
"""
