"""The subcommands of ``robomech``, one module each with `add_arguments` and `run`."""
