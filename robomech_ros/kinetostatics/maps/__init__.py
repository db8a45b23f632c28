"""Maps of reach and dexterity over a grid."""
