"""The server of the view: who may come in, what is let through, who commands."""
