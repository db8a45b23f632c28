"""The Denavit-Hartenberg table of the arm, of which numbers are changed."""

from __future__ import annotations

from typing import Any

from robomech_ros.rvs.model.dh_editing import changed_robot, read_change, table_of, yaml_of
from robomech_ros.rvs.page.audience import Controls
from robomech_ros.rvs.page.dh_rows import CHANGE, dh_rows
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Place

__all__ = ["DHTableLayer"]

ORDER = 15


class DHTableLayer:
    """The layer.

    Parameters
    ----------
    place : Place
    """

    def __init__(self, place: Place) -> None:
        self._place = place
        # The robot that the page began with, and whether another one came from here.
        self._kept = place.kept.setdefault("dh table", {"open": False})
        self._kept.setdefault("first", (place.description, place.chain))
        self._folder: Folder | None = None
        self._rows: Any = None
        self._version, self._typed = 0, False

    def show(self) -> None:
        """Bring back the numbers that were typed over and refused."""
        if self._typed:
            self._typed = False
            self._version += 1
            self._write()

    def controls(self, client: Any) -> Controls:
        """Give a browser the folder "DH table"."""
        folder = self._folder = Folder(client.gui, "DH table", ORDER, expanded=self._kept["open"])
        with folder:
            self._rows = folder.text()
            hint = "Joint, parameter and number, as in: 2 a 0.5; a number typed above does it, too"
            folder.listen(client.gui.add_text(CHANGE, "", hint=hint), self._change)
            folder.button("Reset robot", self._reset, "Back to the robot that the page began with")
        self._write()
        return folder

    def close(self) -> None:
        """Nothing runs."""

    def _write(self) -> None:
        if self._folder is None or self._folder.removed:
            return
        chain = self._place.chain
        table = table_of(chain)
        self._rows.content = dh_rows(
            table, chain.joint_names, chain.units, yaml_of(chain, table), self._version
        )

    def _change(self, text: str) -> None:
        def change() -> None:
            self._typed = True
            chain = self._place.chain
            robot = changed_robot(chain, read_change(text, chain.n))
            self._replace(*robot)

        if text.strip():
            self._place.ask((self, "change"), change)

    def _reset(self) -> None:
        self._place.ask((self, "reset"), lambda: self._replace(*self._kept["first"]))

    def _replace(self, *robot: Any) -> None:
        before = self._kept["open"]
        self._kept["open"] = True
        try:
            self._place.replace(*robot)
        except BaseException:
            self._kept["open"] = before
            raise
