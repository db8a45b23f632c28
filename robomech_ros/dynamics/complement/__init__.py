"""Bodies under constraints of any kind, by the natural orthogonal complement."""
