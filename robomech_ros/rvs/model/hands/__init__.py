"""A hand that holds an object: contacts, drawing, and closure."""
