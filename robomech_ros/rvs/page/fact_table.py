"""Tables of facts, and sentences, in folders of controls."""

from __future__ import annotations

import html
from collections.abc import Sequence

SMALL = "font-size:0.8em;line-height:1.4;padding:0 0.85em 0.4em;font-variant-numeric:tabular-nums"


def fact_table(name: str, facts: Sequence[tuple[str, str]]) -> str:
    """Write names and what is known of them as HTML; of an empty name only the fact is seen.

    Parameters
    ----------
    name : str
        Of the table, as the attribute ``data-name``.
    facts : sequence of two str
        Text, not HTML.
    """
    rows = []
    for what, fact in facts:
        cell = html.escape(fact)
        if what:
            left = f'<td style="padding:0.1em 0.7em 0.1em 0;opacity:0.7">{html.escape(what)}</td>'
            rows.append(f'<tr style="vertical-align:top">{left}<td>{cell}</td></tr>')
        else:
            rows.append(f'<tr><td colspan="2" style="padding:0.2em 0">{cell}</td></tr>')
    table = f'<table style="border-collapse:collapse">{"".join(rows)}</table>'
    return f'<div style="{SMALL}" data-{name}>{table}</div>'
