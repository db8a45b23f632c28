"""Any other arm of six joints, through its problem of degree sixteen."""
