"""Default address of pages."""

# Only this machine; the port is viser's.
HOST, PORT = "127.0.0.1", 8080
GREATEST_PORT = 65535
