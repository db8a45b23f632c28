"""Storage of recordings, motion files, pictures, and the view in the address."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import Any

from robomech_ros.errors import BadValueError
from robomech_ros.rvs.model.motions.recorder import Recorder
from robomech_ros.rvs.model.view_state import ViewState, state_from_text, text_from_state
from robomech_ros.rvs.page.clients import Controls
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.page.recording import motion_page
from robomech_ros.rvs.serving.scripts import keep_in_address, read_address_into, save_picture
from robomech_ros.rvs.serving.ticker import Ticker

VIEW = "View"
RECORD, END = "Record", "End the recording"
# The address follows what is seen so late (s): browsers take few changes a second.
LATE = 0.5


class RecordingLayer(Layer):
    """Keeps what is done and seen."""

    label, order = "Keep", 60

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        self.recorder = Recorder()
        self.known: KnownBrowsers = context.saved_values.setdefault("keeping", KnownBrowsers())
        self.known.notice = self.notice
        self._client: Any = None
        self.record: Any = None
        self.view: Any = None
        # The state that was written into the address last.
        self.written = ""
        self._ticker = Ticker("address", LATE, self._follow)

    def show(self) -> None:
        """Keep where the arm is."""
        recorder = self.recorder
        if recorder.running and not recorder.add(time.monotonic(), self._context.arm.q):
            self._end()
        self.notice()

    def controls(self, client: Any) -> Controls:
        """Add the folder Keep to the commanding browser."""
        self._client, self.written = client, ""
        folder = super().controls(client)
        # Later its address says only where this browser left the arm.
        if self.known.is_new(client):
            read_address_into(client, VIEW)
        return folder

    def _fill(self, folder: Folder, gui: Any) -> None:
        client, label = self._client, END if self.recorder.running else RECORD
        hint = "What the arm does becomes the plan"
        self.record = folder.button(label, self.record_or_end, hint)
        download = partial(self.download, client)
        folder.button("Save the plan", download, "As a page in a file that plays it")
        picture = partial(save_picture, client, "view.png")
        folder.button("Save a picture", picture, "Of the scene, as PNG")
        hint = "Posture, eye and what is shown; it is in the address of this page, too"
        self.view = gui.add_text(VIEW, "", hint=hint)
        folder.listen(self.view, partial(self._restore, client))

    def _restore(self, client: Any, text: str) -> None:
        if text != self.written:
            self.ask("view", self.restore, text, client)

    def notice(self) -> None:
        """Update the address with the present view."""
        self._ticker.start()

    # Requests of the controls, on the thread of the page.

    def record_or_end(self) -> None:
        """Begin a recording, or end it and show it as the plan."""
        if self.recorder.running:
            self._end()
        else:
            self.recorder.begin(time.monotonic(), self._context.arm.q)
            self._label()

    def download(self, client: Any) -> None:
        """Send the plan that is shown to a browser, as a page in a file."""
        context = self._context
        motion, name, world = context.plan.motion, context.chain.name, context.arm.world
        if motion is None:
            raise BadValueError("plan", "none", "a plan or a recording to be saved")
        title = f"{name}: {context.plan.name}"
        objects = world.objects if world is not None and context.switched()["objects"] else {}

        def write() -> None:
            page = motion_page(context.description, motion, title, objects=objects)
            client.send_file_download(f"{name}.html", page.encode(), save_immediately=True)

        self._worker.submit("download", write)

    def restore(self, text: str, client: Any) -> None:
        """Show what a text says, or refuse it as a whole."""
        context = self._context
        # A rejected state does not stay in the address.
        self.written = ""
        state = state_from_text(text, context.chain.n, tuple(context.switched()))
        context.arm.move_to(context.arm.checked(state.q))
        for what, shown in state.shown.items():
            context.switch(what, shown)
        client.camera.position, client.camera.look_at = state.eye, state.at

    # Internal steps.

    def _end(self) -> None:
        try:
            motion = self.recorder.end(time.monotonic(), self._context.chain)
        finally:
            self._label()
        self._context.plan.show(motion, "recording")

    def _label(self) -> None:
        if self.is_open:
            self.record.label = END if self.recorder.running else RECORD

    def _follow(self) -> None:
        # Once for each change.
        self._ticker.stop()
        self._context.run("address", self._write)

    def _write(self) -> None:
        context = self._context
        if not self.is_open or self._ticker.is_closed:
            return
        camera = self._client.camera
        state = ViewState(context.arm.q, camera.position, camera.look_at, context.switched())
        text = text_from_state(state)
        if text != self.written:
            self.written = self.view.value = text
            keep_in_address(self._client, text)


class KnownBrowsers:
    """The browsers that have commanded; those of one robot, the next one knows, too.

    - ``notice``: called when the camera of one of them moves.
    """

    def __init__(self) -> None:
        self.notice: Callable[[], None] = lambda: None
        self._numbers: set[int] = set()

    def is_new(self, client: Any) -> bool:
        """Return whether a browser (viser.ClientHandle) commands for the first time."""
        if client.client_id in self._numbers:
            return False
        self._numbers.add(client.client_id)

        @client.camera.on_update
        async def _(_: Any) -> None:
            self.notice()

        return True
