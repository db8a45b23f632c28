"""Plans: made between two remembered postures or given, swept, traced, drawn and played."""

from __future__ import annotations

import html
import time
from functools import partial
from typing import TYPE_CHECKING, Any

from robomech_ros.errors import BadValueError, RobomechError
from robomech_ros.parallel import Mechanism
from robomech_ros.rvs.layers.motion_scene import MotionScene, SweptPlan, swept
from robomech_ros.rvs.model.motions.motion_curves import (
    QUANTITIES,
    MotionCurves,
    driven_joints,
    motion_curves,
)
from robomech_ros.rvs.model.motions.planning import JOINTS, PATH_KINDS, MadePlan, plan_between
from robomech_ros.rvs.model.motions.player import FASTEST, SLOWEST, Player
from robomech_ros.rvs.motion import Motion
from robomech_ros.rvs.page.curves import ALL, cursor_rule, curves_picture
from robomech_ros.rvs.page.folder import Folder
from robomech_ros.rvs.page.layer import Layer, LayerContext
from robomech_ros.rvs.serving.ticker import Ticker
from robomech_ros.spatial.arrays import as_choice
from robomech_ros.trajectory import PROFILES
from robomech_ros.typing import Array

if TYPE_CHECKING:
    from robomech_ros.rvs.model.world import MotionVerdict

# A motion that plays moves on so often (s).
BEAT = 0.04
# Instead of the name of a quantity.
NO_CURVES = "none"
CURVES = (*QUANTITIES, ALL, NO_CURVES)
# Steps of the slider of the time (s), and of the speed; decimals that their fields have room for.
STEP, SPEED_STEP, DECIMALS = 0.01, 0.1, 2
START, GOAL = "Start here", "Goal here"
_STATUS = '<div style="font-size:0.85em;padding:0 0.85em 0.4em" data-plan>{lines}</div>'
_LINE = "<div{style} {name}>{text}</div>"
_WARNS = ' style="border-left:3px solid #d9480f;padding-left:0.6em"'


class MotionLayer(Layer):
    """The plan of a page."""

    label, order = "Motion", 40

    def __init__(self, context: LayerContext) -> None:
        super().__init__(context)
        self._robot = context.jogged or context.platform.mechanism
        self._scene = MotionScene(context)
        gui = context.server.gui
        # Below the folder of the controls, for all browsers.
        self._picture = gui.add_html("", order=40.5)
        self._cursor = gui.add_html("", order=40.6)
        self.player = Player()
        self.path_kind, self.profile = JOINTS, "poly345"
        self.curves, self.sweep, self.along = QUANTITIES[0], True, False
        end = context.moved.end
        links = context.chain.links if context.jogged else (end,)
        self.traced = {link: link == end for link in links}
        self.status, self.warns = "No plan yet: press Start here, move it, Goal here.", False
        # Verdict on contacts of the plan, and the plan and world that it is for.
        self.verdict: MotionVerdict | None = None
        self._judged: object = None
        self._ends: dict[str, Any] = {}
        self._asked: Motion | None = None
        self._plan: SweptPlan | None = None
        self._drawn: MotionCurves | None = None
        self._degrees = False
        self._last = 0.0
        self._ticker = Ticker("player", BEAT, partial(context.run, "beat", self._step))

    # Calls of the page.

    def show(self) -> None:
        """Follow the plan of the page."""
        motion = self._context.plan.motion
        if self._degrees != self._context.units.degrees:
            self._draw()
        self._judge(motion)
        if self.is_open and self._way_choice.options != self._ways:
            self._way_choice.options = self._ways
        if motion is not self._asked:
            self._asked = motion
            if motion is None:
                self._display(None, None)
            else:
                shown = motion
                self.find(
                    "prepare", lambda: (swept(shown), motion_curves(shown)), self._show_prepared
                )

    def _fill(self, folder: Folder, gui: Any) -> None:
        self._status = folder.text()
        for label, which in ((START, "start"), (GOAL, "goal")):
            hint = f"The present posture is the {which} of a plan"
            folder.button(label, partial(self.remember, which), hint)
        self._way_choice = folder.dropdown(
            "Way", self._ways, self.path_kind, partial(self._choose, "way")
        )
        folder.dropdown("Profile", tuple(PROFILES), self.profile, partial(self._choose, "profile"))
        self._add_playing(folder, gui)
        folder.dropdown("Curves", CURVES, self.curves, self.choose_curves)
        folder.checkbox("sweep of ghosts", self.sweep, self._choose_sweep)
        folder.button("Forget the plan", self.forget)
        with gui.add_folder("Trace", expand_by_default=False):
            for link, shown in self.traced.items():
                folder.checkbox(link, shown, partial(self._choose_trace, link))
        self._load()

    def _add_playing(self, folder: Folder, gui: Any) -> None:
        player = self.player
        self._time = gui.add_slider("Time", 0.0, 1.0, STEP, 0.0, hint="s")
        self._time.precision = DECIMALS
        folder.listen(self._time, partial(self.ask, "seek", self.seek))
        self._play = folder.button("Play", self.play_or_pause)
        hint = "Times as fast as planned"
        speed = gui.add_slider("Speed", SLOWEST, FASTEST, SPEED_STEP, player.speed, hint=hint)
        folder.listen(speed, partial(self.ask, "speed", player.set_speed))
        folder.checkbox("loop", player.loop, partial(setattr, player, "loop"))
        hint = "The robot itself goes where the ghost at the time is"
        folder.checkbox("arm goes along", self.along, partial(setattr, self, "along"), hint)

    def _load(self) -> None:
        """Show another plan in the controls."""
        if not self.is_open:
            return
        duration = self.player.duration
        self._time.disabled = self._play.disabled = not duration > 0.0
        self._time.max = max(duration, STEP)
        self._update()

    def _update(self, *, keep_time: bool = False) -> None:
        """Show where the player is; the slider of the time is left where it is if it asked."""
        if not self.is_open:
            return
        if not keep_time:
            self._time.value = self.player.time
        self._play.label = "Pause" if self.player.playing else "Play"
        said = [("", self.status, self.warns)]
        if self.verdict is not None:
            said.append(("data-verdict", self.verdict.sentence, self.verdict.warns))
        lines = [
            _LINE.format(style=_WARNS if warns else "", name=name, text=html.escape(text))
            for name, text, warns in said
        ]
        self._status.content = _STATUS.format(lines="".join(lines))

    # Requests of the controls, each on the thread of the page.

    def _choose(self, what: str, value: str) -> None:
        chosen = {"way": self.path_kind, "profile": self.profile, what: value}
        self.choose_plan(chosen["way"], chosen["profile"])

    def choose_plan(self, path_kind: str, profile: str) -> None:
        """Plan in another way."""
        self.path_kind = as_choice("way", path_kind, self._ways)
        self.profile = as_choice("profile", profile, tuple(PROFILES))
        self.make_plan()

    def remember(self, which: str) -> None:
        """Take the present posture as start or goal, and plan if both are there."""
        self._ends[which] = self._context.moved.q.copy()
        self.make_plan()

    def make_plan(self) -> None:
        """Plan from start to goal, as far as they are there."""
        missing = [which for which in ("start", "goal") if which not in self._ends]
        if missing:
            self._say(f"The {' and the '.join(missing)} of a plan: not chosen yet.", False)
            return
        ends = self._ends["start"], self._ends["goal"]
        robot, kind, profile = self._robot, self.path_kind, self.profile
        world = self._context.moved.world
        around = None if world is None or kind in PATH_KINDS else world.planner()

        def compute() -> None:
            try:
                if around is not None:
                    made = around(*ends, kind, profile)
                else:
                    made = plan_between(robot, *ends, kind, profile)
            except RobomechError as error:
                made = MadePlan(None, str(error), False)
            self._context.ask("plan", lambda: self._take(made))

        self._worker.submit("plan", compute)

    def forget(self) -> None:
        """Forget the plan, its start and its goal."""
        self._ends = {}
        self._context.plan.forget()
        self._say("No plan.", False)

    def seek(self, seconds: float) -> None:
        """Go to a time of the plan (s)."""
        self.player.seek(seconds)
        self._move(from_slider=True)

    def play_or_pause(self) -> None:
        """Play, or stay where it is."""
        if self._plan is None:
            raise BadValueError("plan", "none", "a plan to play")
        if self.player.playing:
            self.player.pause()
        else:
            self.player.play()
            self._last = time.monotonic()
            self._ticker.start()
        self._move()

    def choose_curves(self, name: str) -> None:
        """Draw this quantity, all, or none."""
        self.curves = as_choice("curves", name, CURVES)
        self._draw()

    def _choose_sweep(self, shown: bool) -> None:
        self.sweep = shown
        self._choose_traces()

    def _choose_trace(self, link: str, shown: bool) -> None:
        self.traced[link] = shown
        self._choose_traces()

    def _choose_traces(self) -> None:
        self._scene.show(self._plan, self.sweep, [k for k, chosen in self.traced.items() if chosen])

    # Internal steps.

    @property
    def _ways(self) -> tuple[str, ...]:
        world = self._context.moved.world
        return PATH_KINDS if world is None else (*PATH_KINDS, *world.ways)

    def _judge(self, motion: Motion | None) -> None:
        """Check whether a plan is free of contact, again after each change of the world."""
        world = self._context.moved.world
        wanted = None if motion is None or world is None else (motion, world, world.version)
        if wanted == self._judged:
            return
        self._judged = wanted
        if motion is None or world is None:
            self._take_verdict(wanted, None)
        else:
            take = partial(self._take_verdict, wanted)
            self.find("judge", partial(world.judge(), motion), take)

    def _take_verdict(self, judged: object, verdict: MotionVerdict | None) -> None:
        if judged == self._judged:
            self.verdict = verdict
            self._update(keep_time=True)

    def _closed(self, q: Array) -> Array:
        """Close the loops of a posture between two samples of a plan."""
        if isinstance(self._robot, Mechanism):
            return self._robot.close(q[self._robot.drive_index], q).q
        return q

    def _show_prepared(self, prepared: tuple[SweptPlan, MotionCurves]) -> None:
        # Another one may have come meanwhile, or another robot.
        if prepared[0].motion is self._asked and not self._ticker.is_closed:
            self._display(*prepared)

    def _take(self, made: MadePlan) -> None:
        self._say(made.sentence, not made.complete)
        if made.motion is None:
            self._context.plan.forget()
        else:
            self._context.plan.show(made.motion, "plan")

    def _display(self, plan: SweptPlan | None, curves: MotionCurves | None) -> None:
        self._plan, self._drawn = plan, curves
        self.player.load(0.0 if plan is None else plan.motion.duration)
        self._choose_traces()
        self._draw()
        # The slider takes a time before the text names the plan.
        self._load()
        name = self._context.plan.name
        if plan is not None and name != "plan":
            self._say(f"{name}: {plan.motion.duration:.2f} s", False)
        self._move()

    def _draw(self) -> None:
        text, units = "", self._context.units
        self._degrees = units.degrees
        if self._drawn is not None and self.curves != NO_CURVES:
            names = [self._robot.joint_names[k] for k in driven_joints(self._robot)]
            text = curves_picture(names, self._drawn, self.curves, units)
        self._picture.content = text

    def _say(self, sentence: str, warns: bool) -> None:
        self.status, self.warns = sentence, warns
        self._update()

    def _move(self, *, from_slider: bool = False) -> None:
        """Show the time where the player is."""
        if self._plan is None:
            return
        motion, player = self._plan.motion, self.player
        q = motion.at(motion.times[0] + player.time)
        with self._context.server.atomic():
            self._scene.go_to(q)
            self._cursor.content = cursor_rule(player.time / max(player.duration, 1e-9))
            self._update(keep_time=from_slider)
        if self.along:
            self._context.ask("along", lambda: self._context.moved.move_to(self._closed(q)))

    def _step(self) -> None:
        now = time.monotonic()
        if self._ticker.is_closed:
            return
        if self.player.playing:
            self.player.advance(now - self._last)
            self._move()
        if not self.player.playing:
            self._ticker.stop()
        self._last = now
