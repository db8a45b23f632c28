"""Remake the pictures of the browser view in doc/images; `make pictures`.

Each is a page in a headless Chromium, drawn in software: no two machines need give the same bytes.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from PIL import Image

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "rvs")]

from chromium import Tab, chromium  # noqa: E402
from controls import button, field, heading, press, write  # noqa: E402
from raw_client import wait_until  # noqa: E402
from world_cases import HERE as BESIDE, ROBOT, SCENE  # noqa: E402

from robomech_ros.kinematics import branch_path, forward_kinematics  # noqa: E402
from robomech_ros.robots import load_robot  # noqa: E402
from robomech_ros.rvs import Motion, view  # noqa: E402
from robomech_ros.trajectory import point_to_point  # noqa: E402

IMAGES = HERE.parent.parent / "doc" / "images"
WIDTH, HEIGHT = 1120, 680
# Colours of a picture that would have too many bytes, and the most that it may have.
COLOURS, MOST = 256, 200_000
# A posture that is far from singular, and what is drawn in so many frames has settled.
Q = [0.3, -1.2, 1.5, -0.8, 0.9, 0.2]
SETTLED = 30
# The moving picture: name, frames, how long each is seen (ms), radius of the circle (m).
MOVING, FRAMES, PERIOD, RADIUS = "moving_postures", 40, 90, 0.1
# The part of the page that it shows, its size, its colours, and its most bytes.
SCENE_PART, SMALLER, FEWER, MOST_MOVING = (0, 0, 732, 680), (560, 520), 64, 1_000_000


def robot(page, tab) -> None:
    """The robot alone."""
    press(tab, heading("Show"))
    press(tab, field("ghosts"))
    press(tab, field("joint axes"))


def ghosts(page, tab) -> None:
    """All postures of a pose."""
    take(page, Q)
    press(tab, button("Fit view"))


def contours(page, tab) -> None:
    """Contours with all crossings, and one that was clicked on."""
    take(page, Q)
    press(tab, heading("Contours"))
    press(tab, field("contours"))
    tab.wait_for("document.querySelector('[data-plot] [data-curve]')")
    press(tab, button("Mark all crossings"))
    tab.wait_for("document.querySelector('[data-plot] [data-mark=spurious]')")
    first, second = page._arm.study.postures[4].q[3:5] + [-0.35, 0.2]
    write(tab, "Estimate", f"{first:.2f}, {second:.2f}")
    tab.wait_for("document.querySelector('[data-plot] [data-steps]')")
    press(tab, button("Fit view"))
    tab.value("document.querySelector('[data-plot]').scrollIntoView({block: 'start'})")


def motion(page, tab) -> None:
    """A plan as a sweep of ghosts, with its curves."""
    arm = page._arm.chain
    plan = point_to_point(Q, np.array(Q) + [1.4, 0.6, -0.9, 0.8, 0.4, 0.5], limits=arm)
    times = np.linspace(0.0, plan.duration, 101)
    page.show_plan(Motion(arm, times, np.array([plan.sample(t).position for t in times])), "swing")
    press(tab, heading("Motion"))
    tab.wait_for("document.querySelector('[data-curves]')")
    press(tab, button("Fit view"))
    tab.value("document.querySelector('[data-curves]').scrollIntoView({block: 'end'})")


def workspace(page, tab) -> None:
    """The boundary as a section and as a surface."""
    press(tab, heading("Workspace"))
    press(tab, field("boundary"))
    tab.wait_for("document.querySelector('[data-section] [data-count]')")
    tab.wait_for("__viserMutable.nodeRefFromName['/base/workspace_surface']")
    press(tab, button("See all of it"))
    # The folder takes its time to open.
    tab.frames(SETTLED)
    tab.value("document.querySelector('[data-workspace]').scrollIntoView({block: 'end'})")


def platform(page, tab) -> None:
    """A parallel robot, and the list of its assembly modes."""
    page.show("ghosts", False)
    tab.wait_for("document.querySelector('[data-platform]').innerText.includes('type 2')")
    press(tab, button("Fit view"))


def hand(page, tab) -> None:
    """An object in a hand, with friction cones and the forces that hold it."""
    tab.wait_for("__viserMutable.nodeRefFromName['/base/force_linear']")
    tab.wait_for("document.querySelector('[data-grasp]').innerText.includes('weakest direction')")
    press(tab, button("Fit view"))


def world(page, tab) -> None:
    """Objects around an arm, the nearest pair, and postures that are struck out."""
    take(page, BESIDE)
    page.show("gizmo", False)
    pose = page._arm.world.objects["wall"].pose.copy()
    pose[:3, 3] = 0.6, 0.25, 0.3
    page._ask("wall", lambda: page._arm.world.move("wall", pose))
    page.take("5")
    tab.wait_for("document.querySelector('[data-contact]')")
    press(tab, button("Fit view"))


def take(page, q) -> None:
    """Bring the arm to a posture."""
    page._ask("posture", lambda: page._arm.move_to(q))
    wait_until(lambda: np.array_equal(page._arm.q, q))


# Robot, what is done on its page, and perhaps a scene around it.
PICTURES: dict[str, tuple] = {
    "view_robot": ("ur5e", robot),
    "view_ghosts": ("ur5e", ghosts),
    "view_contours": ("ur5e", contours),
    "view_motion": ("ur5e", motion),
    "view_workspace": ("puma560", workspace),
    "view_linapod": ("linapod", platform),
    "view_tripod": ("tripod_3prs", platform),
    "view_hand": ("three_fingered", hand),
    "view_world": (ROBOT, world, SCENE),
}


@contextmanager
def opened(name: str) -> Iterator[tuple]:
    """Open the page of a picture in a browser, and prepare it."""
    what, prepare, *scene = PICTURES[name]
    with view(what, port=0, scene=scene[0] if scene else None) as page:
        tab = Tab(f"{page.url}&fixedDpr=1", WIDTH, HEIGHT)
        try:
            tab.wait_for("__viserMutable.nodeRefFromName['/base/target']")
            tab.wait_for("document.querySelector('[data-postures]')")
            # That it is drawn in software is not what the picture is to show.
            press(tab, "document.querySelector('.mantine-Notification-closeButton')")
            prepare(page, tab)
            tab.wait_for("!document.querySelector('.mantine-Notification-root')")
            tab.frames(SETTLED)
            yield page, tab
        finally:
            tab.close()


def draw(name: str) -> Path:
    """Write one picture."""
    with opened(name) as (_, tab), tempfile.TemporaryDirectory() as folder:
        raw = Path(folder) / "raw.png"
        tab.picture(raw)
        return compressed(raw, IMAGES / f"{name}.png")


def draw_moving() -> Path:
    """Write the moving picture: the tip goes round a circle, and all postures follow."""
    arm, a = load_robot("ur5e"), np.linspace(0.0, 2.0 * np.pi, FRAMES, endpoint=False)
    poses = np.tile(forward_kinematics(arm, Q), (FRAMES, 1, 1))
    poses[:, 0, 3] += RADIUS * (np.cos(a) - 1.0)
    poses[:, 2, 3] += RADIUS * np.sin(a)
    frames = []
    with opened("view_ghosts") as (page, tab), tempfile.TemporaryDirectory() as folder:
        page.show("gizmo", False)
        for q in branch_path(arm, poses, start=Q).q:
            take(page, q)
            tab.frames(6)
            tab.picture(Path(folder) / "raw.png")
            with Image.open(Path(folder) / "raw.png") as picture:
                frames.append(picture.convert("RGB").crop(SCENE_PART).resize(SMALLER))
    # One palette for all frames, so that what stands still is the same in each.
    palette = frames[0].quantize(FEWER, method=Image.Quantize.FASTOCTREE)
    first, *others = (one.quantize(palette=palette, dither=Image.Dither.NONE) for one in frames)
    path = IMAGES / f"{MOVING}.gif"
    first.save(path, save_all=True, append_images=others, duration=PERIOD, loop=0, optimize=True)
    return checked_size(path, MOST_MOVING)


def compressed(raw: Path, path: Path) -> Path:
    """Write a picture in as many colours as its bytes allow."""
    with Image.open(raw) as picture:
        plain = picture.convert("RGB")
    plain.save(path, optimize=True)
    if path.stat().st_size > MOST:
        plain.quantize(COLOURS, method=Image.Quantize.FASTOCTREE).save(path, optimize=True)
    return checked_size(path, MOST)


def checked_size(path: Path, most: int) -> Path:
    """Return a picture's path, or end the program if the picture has more bytes."""
    size = path.stat().st_size
    if size > most:
        raise SystemExit(f"pictures: {path.name} has {size} bytes, at most {most} are wanted")
    return path


def main() -> None:
    """Remake the pictures that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=sorted([*PICTURES, MOVING]), help="one picture")
    only = parser.parse_args().only
    if chromium() is None:
        raise SystemExit("pictures: no Chromium is found here: sudo apt-get install chromium")
    for name in [only] if only else [*PICTURES, MOVING]:
        path = draw_moving() if name == MOVING else draw(name)
        print(f"pictures: {path} ({path.stat().st_size // 1000} kB)")


if __name__ == "__main__":
    main()
