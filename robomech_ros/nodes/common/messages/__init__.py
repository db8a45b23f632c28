"""Messages to and from arrays, and goals of actions."""
