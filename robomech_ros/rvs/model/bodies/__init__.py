"""Bodies that are drawn, as triangles."""
