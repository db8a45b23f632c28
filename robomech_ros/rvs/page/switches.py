"""Checkboxes of a layer's folder, stored in the address of the page."""

from collections.abc import Callable, Mapping
from functools import partial

from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import LayerContext, Switch


class Switches:
    """The switches of a layer.

    - ``labels``: labels on the page, by name.
    - ``on``: which of them are on; changed here.
    - ``changed``: called with the name of a switch and whether a person has changed it on the page.
    """

    def __init__(
        self,
        context: LayerContext,
        labels: Mapping[str, str],
        on: dict[str, bool],
        changed: Callable[[str, bool], None] = lambda name, asked: None,
    ) -> None:
        self._labels, self._on, self._changed = labels, on, changed
        self._folder: Folder | None = None
        for name, label in labels.items():
            context.offered[label] = Switch(partial(on.__getitem__, name), partial(self.turn, name))

    def __getitem__(self, name: str) -> bool:
        return self._on[name]

    def add_to(self, folder: Folder, name: str, hint: str | None = None) -> None:
        """Add the checkbox of a switch to a folder."""
        self._folder = folder
        change = partial(self.turn, name, asked=True)
        folder.checkbox(self._labels[name], self._on[name], change, hint)

    def turn(self, name: str, on: bool, asked: bool = False) -> None:
        """Switch on or off."""
        self._on[name] = on
        self._changed(name, asked)
        if self._folder is not None:
            self._folder.mark(self._labels[name], on)
