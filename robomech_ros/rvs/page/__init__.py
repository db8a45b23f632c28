"""The page of the view, drawn with viser."""
