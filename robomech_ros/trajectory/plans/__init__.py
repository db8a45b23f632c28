"""Plans: from point to point, through via points, along paths; and their verification."""
