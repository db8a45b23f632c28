"""Scripts of ours that run in a browser."""

import json
from typing import Any

from viser import _messages

# The picture is what was drawn last; a link that is clicked saves it.
_PICTURE = """__viserMutable.canvas.toBlob(function (blob) {
  var link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = %s;
  link.click();
  setTimeout(function () { URL.revokeObjectURL(link.href); }, 10000);
}, 'image/png');"""
_KEEP = """var query = new URLSearchParams(location.search);
query.delete('view');
query.delete('websocket');
var rest = query.toString();
history.replaceState(history.state, '', '?' + (rest ? rest + '&' : '') + 'view=' + %s);"""
# The page is a React page: a field takes a value only by its native setter, and an event.
_READ = """var state = new URLSearchParams(location.search).get('view'), tries = 0;
function put() {
  var label = [].slice.call(document.querySelectorAll('label')).find(function (label) {
    return label.textContent === %s; });
  var input = label && label.closest('.mantine-Flex-root').querySelector('input');
  if (input) {
    Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set.call(input, state);
    input.dispatchEvent(new Event('input', {bubbles: true}));
  } else if (tries++ < 600) setTimeout(put, 100);
}
if (state) put();"""


def save_picture(client: Any, name: str) -> None:
    """Make a browser (viser.ClientHandle) save its view of the scene as a PNG file."""
    _run(client, _PICTURE % json.dumps(name))


def keep_in_address(client: Any, state: str) -> None:
    """Write a state, a text that needs no escaping, into the address of a browser."""
    _run(client, _KEEP % json.dumps(state))


def read_address_into(client: Any, label: str) -> None:
    """Make a browser copy the state of its address into the field of a label."""
    _run(client, _READ % json.dumps(label))


def _run(client: Any, source: str) -> None:
    # viser runs the scripts of its plots in this way, and has no public one.
    client._websock_connection.queue_message(_messages.RunJavascriptMessage(source=source))


def script_that_fills(label: str) -> str:
    """Return JavaScript that writes ``text`` into the text field of a label, as if it were typed.

    - ``label``: without quotes.

    Nothing is written where there is no such field, or ``text`` is empty.  The same
    text with a blank is another value, so that it counts again.
    """
    # The page is a React page: a field takes a value only by its native setter, and an event.
    return (
        "var l=[].slice.call(document.querySelectorAll('label')).find(function(l){"
        f"return l.textContent==='{label}'}}),"
        "i=l&&l.closest('.mantine-Flex-root').querySelector('input,textarea');"
        "if(text&&i){Object.getOwnPropertyDescriptor(Object.getPrototypeOf(i),'value').set"
        ".call(i,i.value===text?text+' ':text);"
        "i.dispatchEvent(new Event('input',{bubbles:true}))}"
    )
