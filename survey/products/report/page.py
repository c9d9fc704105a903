"""The page itself: how it looks, and how a figure stands in it."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape

STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #222; max-width: 76rem;
       margin: 1.5rem auto; padding: 0 1rem; }
h1 { font-size: 1.7rem; margin: 0 0 0.3rem; }
h2 { font-size: 1.2rem; margin: 2.2rem 0 0.4rem; border-bottom: 1px solid #bbb; }
p, table { max-width: 62rem; }
.verdict { border-left: 4px solid #0072b2; margin: 0.8rem 0; padding: 0.1rem 0 0.1rem 0.8rem; }
.verdict p { margin: 0.2rem 0; }
.figures { display: grid; grid-template-columns: repeat(auto-fit, minmax(26rem, 1fr));
         gap: 0.8rem 1.6rem; align-items: start; }
figure { margin: 0.6rem 0; break-inside: avoid; }
figcaption { font-size: 0.9rem; color: #444; max-width: 46rem; }
table { border-collapse: collapse; } td { padding: 0.25rem 1rem 0.25rem 0;
       border-bottom: 1px solid #ddd; vertical-align: top; }
td:first-child { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap;
       font-weight: 600; }
img { max-width: 100%; height: auto; }
@media print { body { margin: 0; max-width: none; font-size: 11px; }
       .figures { grid-template-columns: 1fr 1fr; } h2 { break-after: avoid; } }
"""


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A picture of the report.

    Parameters
    ----------
    name : str
        Of its file, without a suffix.
    png : bytes
    words : str
        What it shows, in a sentence.
    """

    name: str
    png: bytes
    words: str

    def html(self) -> str:
        """Return the picture with its sentence."""
        data, words = b64encode(self.png).decode(), escape(self.words)
        source = f"data:image/png;base64,{data}"
        title = escape(self.name.replace("-", " "))
        return (
            f'<figure><img alt="{title}" src="{source}"><figcaption>{words}</figcaption></figure>'
        )


def figures(shown: Iterable[Figure]) -> list[str]:
    """Return figures side by side where the page is wide."""
    return ['<div class="figures">', *(figure.html() for figure in shown), "</div>"]


def page(title: str, lines: Iterable[str]) -> str:
    """Return a whole page of lines of HTML."""
    body = "\n".join(lines)
    return (
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        f'<meta name="viewport" content="width=device-width">\n'
        f"<title>{escape(title)}</title>\n<style>{STYLE}</style>\n</head>\n"
        f"<body>\n{body}\n</body>\n</html>\n"
    )
