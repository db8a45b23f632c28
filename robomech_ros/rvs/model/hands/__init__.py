"""A hand that holds an object: what is touched, what is drawn, and what holds."""
