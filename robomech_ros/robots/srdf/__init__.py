"""SRDF documents."""
