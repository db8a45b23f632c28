"""Model of the view, independent of any browser."""
