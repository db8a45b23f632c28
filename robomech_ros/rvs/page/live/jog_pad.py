"""Buttons that jog while they are held, as HTML that says so again and again."""

import html
from collections.abc import Sequence

# How often a page says that a button is still held (s).
BEAT = 0.1

# Jogs of the tip: label, and direction.
_TIP = (
    *((axis, "linear", k) for k, axis in enumerate("xyz")),
    *((f"r{axis}", "angular", k) for k, axis in enumerate("xyz")),
)
_STYLE = "font-size:0.8em;padding:0 0.85em 0.6em;display:flex;gap:1.4em;user-select:none"
_BUTTON = (
    "width:2.5em;height:1.9em;margin:1px;border:1px solid rgba(128,128,128,0.6);border-radius:4px;"
    "background:rgba(128,128,128,0.12);color:inherit;font:inherit;font-weight:600;cursor:pointer;"
    "touch-action:none"
)
# Begins when a button is pressed.  Until it is let go, or the page is hidden, left or without its
# field, the field gets direction, press and its age (ms); then it is emptied, twice, since the page
# sends only the last of what two fields get at about the same time.
_PRESS = (
    "var b=event.target.closest('[data-jog]'),"
    "l=document.querySelector('label[for=\"FIELD\"]'),"
    "f=l&&l.closest('.mantine-Flex-root').querySelector('input');"
    "if(b&&f&&event.button===0){event.preventDefault();"
    "var p=Date.now(),s=performance.now(),t=0,"
    "w=function(v){Object.getOwnPropertyDescriptor(HTMLInputElement.prototype,'value').set"
    ".call(f,v);f.dispatchEvent(new Event('input',{bubbles:true}))},"
    "e=function(){if(!t)return;clearInterval(t);t=0;b.style.outline='';"
    "b.removeAttribute('data-held');"
    "window.removeEventListener('blur',e);window.removeEventListener('pagehide',e);"
    "document.removeEventListener('visibilitychange',e);w('');"
    "setTimeout(function(){if(!f.value)w(' ')},120)},"
    "g=function(){if(document.hidden||!b.isConnected||!f.isConnected){e();return}"
    "w(b.dataset.jog+' '+p+' '+Math.round(performance.now()-s))};"
    "t=setInterval(g,PERIOD);b.style.outline='2px solid #e8590c';b.setAttribute('data-held','');"
    "try{b.setPointerCapture(event.pointerId)}catch(x){}"
    "b.onpointerup=b.onpointercancel=b.onlostpointercapture=b.oncontextmenu=e;"
    "window.addEventListener('blur',e);window.addEventListener('pagehide',e);"
    "document.addEventListener('visibilitychange',e);g()}"
)


def jog_pad(field: str, joints: Sequence[str]) -> str:
    """Write the buttons, two for each joint and each axis of the tip, as HTML.

    - ``field``: identifier of the text field that they write into, which is not seen.
    - ``joints``: what the joints are called.
    """
    return hold_pad(field, [[(name, "joint", k) for k, name in enumerate(joints)], _TIP])


def hold_pad(field: str, columns: Sequence[Sequence[tuple[str, str, int]]]) -> str:
    """Write columns of buttons that are held, two a row, as HTML.

    - ``field``: identifier of the hidden text field that the buttons write into.
    - ``columns``: rows of each column: label, kind of jog, and index of the joint or axis.
    """
    script = _PRESS.replace("FIELD", field).replace("PERIOD", str(round(1000 * BEAT)))
    hidden = (
        f'<style>.mantine-Flex-root:has(> div > .mantine-Text-root > label[for="{field}"])'
        "{display:none}</style>"
    )
    written = [
        "".join(_row(html.escape(name), kind, index) for name, kind, index in rows)
        for rows in columns
    ]
    tables = "".join(f'<table style="border-collapse:collapse">{text}</table>' for text in written)
    return (
        f'{hidden}<div style="{_STYLE}" data-jog-pad onpointerdown="{html.escape(script)}">'
        f"{tables}</div>"
    )


def _row(label: str, kind: str, index: int) -> str:
    buttons = "".join(
        f'<button type="button" style="{_BUTTON}" data-jog="{kind} {index} {sign}" '
        f'title="hold to move">{shown}</button>'
        for sign, shown in (("-", "&minus;"), ("+", "+"))
    )
    return f'<tr><td style="padding-right:0.6em">{label}</td><td>{buttons}</td></tr>'
