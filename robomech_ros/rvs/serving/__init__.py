"""The server of the view: access, message filter, and command."""
