"""How results are printed: some lines, and a table in notebooks."""

from __future__ import annotations

import html


def text_of(name: str, lines: list[tuple[str, str]]) -> str:
    """Lines below each other; the first begins with the name of the type."""
    width = max(len(label) for label, _ in lines)
    rows = [f"{label:<{width}}  {' '.join(text.split())}" for label, text in lines]
    indent = "\n" + " " * (len(name) + 1)
    return f"{name}({indent.join(rows)})"


def table_of(lines: list[tuple[str, str]]) -> str:
    """A table of two columns."""

    def row(label: str, text: str) -> str:
        return f"<tr><td>{html.escape(label)}</td><td>{html.escape(text)}</td></tr>"

    return f"<table>{''.join(row(label, text) for label, text in lines)}</table>"
