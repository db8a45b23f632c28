"""Controls of a page in a browser, found by what is written beside them."""

_FIELD = (
    "[...document.querySelectorAll('label')].find(l => l.textContent === '{label}')"
    ".closest('.mantine-Flex-root').querySelector('input, textarea')"
)
_HEADING = (
    "[...document.querySelectorAll('.mantine-Paper-root')]"
    ".find(p => p.textContent.trim() === '{label}')"
)
_BUTTON = "[...document.querySelectorAll('button')].find(b => b.innerText === '{label}')"


def field(label):
    """JavaScript of the field of a label."""
    return _FIELD.format(label=label)


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
