"""Controls of a page in a browser, found by what is written beside them."""

from raw_client import wait_until

_FIELD = (
    "[...document.querySelectorAll('label')].find(l => l.textContent === '{label}')"
    ".closest('.mantine-Flex-root').querySelector('{part}')"
)
_HEADING = (
    "[...document.querySelectorAll('.mantine-Paper-root')]"
    ".find(p => p.textContent.trim() === '{label}')"
)
_BUTTON = "[...document.querySelectorAll('button')].find(b => b.innerText === '{label}')"


def field(label, part="input, textarea"):
    """JavaScript of the field of a label, or of another part of its control."""
    return _FIELD.format(label=label, part=part)


def checkbox(label):
    """JavaScript of a checkbox."""
    return field(label, "input[type=checkbox]")


def number(label):
    """JavaScript of the number beside a slider."""
    return field(label, "input:not([type=hidden])")


def thumb(label):
    """JavaScript of the thumb of a slider."""
    return field(label, "[role=slider]")


def heading(label):
    """JavaScript of the heading of a folder that is closed."""
    return _HEADING.format(label=label)


def button(label):
    """JavaScript of a button."""
    return _BUTTON.format(label=label)


def press(tab, script):
    """Press what JavaScript gives, once it is there."""
    tab.wait_for(script)
    tab.value(f"{script}.click()")


def write(tab, label, text):
    """Type into the field of a label."""
    tab.value(f"(() => {{ const f = {field(label)}; f.focus(); f.select(); }})()")
    tab.send("Input.insertText", text=text)


def pixel(tab, node):
    """Return the pixel of a node's origin."""
    script = f"""(() => {{
        const v = __viserMutable, o = v.nodeRefFromName[{node!r}], c = v.camera;
        o.updateWorldMatrix(true, false); c.updateMatrixWorld();
        const p = o.position.clone().setFromMatrixPosition(o.matrixWorld).project(c);
        const r = v.canvas.getBoundingClientRect();
        return [r.left + (p.x + 1) / 2 * r.width, r.top + (1 - p.y) / 2 * r.height]; }})()"""
    return tab.value(script)


def settled(tab, script):
    """Return the value of JavaScript once it stays the same: folders and the page move at first."""
    seen = []
    wait_until(
        lambda: seen.append(tab.value(script)) or tab.frames(5) or seen[-3:] == seen[-1:] * 3
    )
    return seen[-1]
