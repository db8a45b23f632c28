"""Plans, recordings and curves of motions."""
