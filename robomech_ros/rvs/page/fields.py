"""Text fields that a click elsewhere on the page fills in."""


def script_that_fills(label: str) -> str:
    """Return JavaScript that writes ``text`` into the text field of a label, as if it were typed.

    Parameters
    ----------
    label : str
        Without quotes.

    Returns
    -------
    str
        Nothing is written where there is no such field, or ``text`` is empty.  The same text with
        a blank is another value, so that it counts again.
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
