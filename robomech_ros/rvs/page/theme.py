"""How pages look."""

from typing import Any


def set_theme(gui: Any, dark: bool) -> None:
    """Draw pages dark or light, without anything that leads elsewhere.

    Parameters
    ----------
    gui : viser.GuiApi
        Of all browsers, or of one.
    dark : bool
    """
    gui.configure_theme(
        control_width="large", dark_mode=dark, show_logo=False, show_share_button=False
    )
