"""The documents that `make docs` has built: all of them work as files, without a network."""

import importlib.util
import re
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

import pytest
from PIL import Image

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "doc" / "extensions"))

from words_of_pages import WORDS

BUILT = Path(__file__).resolve().parent.parent / "doc" / "_build"
PAGES = sorted(BUILT.rglob("*.html"))
SCENES = [page for page in PAGES if "__VISER_EMBED_DATA__" in page.read_text("utf-8")]
READ = [page for page in PAGES if page not in SCENES]
LARGEST_API_PAGE = 300_000  # bytes
LONGEST = 1.0  # s to load a page
WIDTH = 1280  # px
DRAWN = 200  # colours of a shaded robot; an empty frame has one
MISSING = importlib.util.find_spec("viser") is None

pytestmark = pytest.mark.skipif(not PAGES, reason="make docs builds the pages")


@contextmanager
def opened(page, width=WIDTH, height=800):
    """Open a page as a file in a Chromium that cannot reach other machines."""
    if MISSING:
        pytest.skip("viser, which brings the websockets, is not installed")
    sys.path.insert(0, str(Path(__file__).parent / "rvs"))
    from chromium import Tab, chromium

    if chromium() is None:
        pytest.skip("no Chromium: sudo apt-get install chromium")
    tab = Tab(page.as_uri(), width, height)
    try:
        tab.wait_for("document.readyState === 'complete'")
        yield tab
        assert tab.errors == []
    finally:
        tab.close()


def test_no_page_and_no_style_loads_anything_from_the_network():
    loads = r"<(?:script|img|iframe|source|video)\b[^>]*\bsrc=\"(?:https?:)?//[^\"]*"
    loads += r"|<link\b[^>]*\brel=\"(?:stylesheet|preload|icon)\"[^>]*\bhref=\"(?:https?:)?//[^\"]*"
    for page in READ:
        assert re.findall(loads, page.read_text("utf-8")) == [], page.name
    for style in BUILT.rglob("*.css"):
        network = r"(?:url\(|@import)\s*[\"']?(?:https?:)?//[^)]*"
        assert re.findall(network, style.read_text("utf-8")) == [], style.name


def test_pages_of_the_interface_are_small():
    sizes = {page.name: page.stat().st_size for page in BUILT.glob("api/*.html")}
    assert len(sizes) > 20
    assert {name: size for name, size in sizes.items() if size > LARGEST_API_PAGE} == {}


def test_all_columns_of_the_book_are_visible():
    with opened(BUILT / "book.html") as tab:
        edges = "[...document.querySelectorAll('main th, article th')].map("
        right = tab.value(f"{edges}cell => cell.getBoundingClientRect().right)")
        assert len(right) > 50
        assert max(right) <= WIDTH
        clipped = "box => box.scrollWidth > box.clientWidth + 1"
        boxes = "[...document.querySelectorAll('.table-wrapper')]"
        assert tab.value(f"{boxes}.filter({clipped}).length") == 0


def test_every_page_shows_its_formulas_within_a_second():
    """A second of the processor: others may use the machine."""
    with opened(BUILT / "index.html") as tab:
        tab.send("Performance.enable", timeDomain="threadTicks")
        shown = 0
        for page in READ:
            tab.open(page.as_uri())
            tab.wait_for(
                f"document.URL === '{page.as_uri()}' && document.readyState === 'complete'"
            )
            if 'class="math ' in page.read_text("utf-8"):
                check_formulas(tab, page.name)
                shown += 1
            assert 0.0 < busy(tab) < LONGEST, page.name
        assert shown > 30


def busy(tab):
    """Return the time (s) that the thread of a page has computed since it was opened."""
    found = tab.send("Performance.getMetrics")["metrics"]
    return next(one["value"] for one in found if one["name"] == "TaskDuration")


def check_formulas(tab, name):
    """Wait until the formulas of a page are drawn, and look for those that are not."""
    tab.wait_for("window.MathJax && MathJax.startup && MathJax.startup.promise")
    tab.value("MathJax.startup.promise.then(() => true)")
    left = "[...document.querySelectorAll('.math')].filter(m => !m.querySelector('svg'))"
    assert tab.value(f"{left}.map(m => m.textContent)") == [], name
    wrong = "[data-mml-node=merror]"
    assert tab.value(f"document.querySelectorAll('{wrong}').length") == 0, name


def test_the_search_lists_the_page_that_answers_first():
    questions = {word: page for page, words in WORDS.items() for word in words}
    assert len(questions) > 30
    with opened(BUILT / "search.html") as tab:
        for word, page in {**questions, "inverse_kinematics": "api/kinematics"}.items():
            tab.open(f"{(BUILT / 'search.html').as_uri()}?q={quote(word)}")
            first = "document.querySelector('#search-results li > a').getAttribute('href')"
            arrived = f"document.URL.endsWith('?q={quote(word)}')"
            tab.wait_for(f"{arrived} && document.querySelector('#search-results li > a')")
            assert tab.value(first).startswith(f"{page}.html"), word


def test_newcomers_reach_the_page_that_answers_in_three_clicks():
    """From the first page, by links in the text alone."""
    reached = {BUILT / "index.html"}
    for _ in range(3):
        for page in list(reached):
            text = page.read_text("utf-8").partition("<article")[2]
            targets = re.findall(r'href="([^":#]+\.html)', text)
            reached |= {(page.parent / target).resolve() for target in targets}
    assert [page for page in WORDS if BUILT / f"{page}.html" not in reached] == []


def test_at_least_five_notebooks_have_scenes():
    assert len(SCENES) >= 5


@pytest.mark.parametrize("scene", SCENES, ids=lambda page: page.stem)
def test_a_scene_turns_with_the_mouse(scene):
    with opened(scene, 640, 400) as tab:
        camera = "__viserMutable.camera.position.toArray().map(x => Math.round(1e4 * x)).join()"
        tab.wait_for("Object.keys(__viserMutable.nodeRefFromName).length > 3")
        tab.frames(5)
        before = tab.value(camera)
        tab.mouse("mousePressed", 320, 200, buttons=1)
        for x in range(330, 430, 20):
            tab.mouse("mouseMoved", x, 210, buttons=1)
        tab.mouse("mouseReleased", 430, 210)
        tab.wait_for(f"{camera} !== '{before}'")


@pytest.mark.parametrize("scene", SCENES, ids=lambda page: page.stem)
def test_a_notebook_shows_its_scene(scene, tmp_path):
    (page,) = [one for one in READ if f'src="{scene.name}"' in one.read_text("utf-8")]
    frame = "document.querySelector('iframe.scene')"
    with opened(page) as tab:
        deadline = time.monotonic() + 120.0
        while colours(tab, tmp_path / "page.png", frame) < DRAWN:
            assert time.monotonic() < deadline, "the scene stays empty"
            tab.frames(5)


def colours(tab, path, element):
    """Count the colours of an element, which formulas above it may have moved."""
    tab.value(f"{element}.scrollIntoView({{block: 'center', behavior: 'instant'}})")
    box = f"(b => [b.left, b.top, b.right, b.bottom])({element}.getBoundingClientRect())"
    left, top, right, bottom = tab.value(box)
    assert right - left > 500
    tab.picture(path)
    with Image.open(path) as seen:
        return len(seen.convert("RGB").crop((left, top, right, bottom)).getcolors(1 << 24))
