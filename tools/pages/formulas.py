"""Formulas as pictures of their own: no script, no font, nothing to load."""

from __future__ import annotations

import re
from functools import cache
from html import unescape
from xml.etree import ElementTree

import ziamath

SIZE = 16.0
"""Of the letters, in the picture's own units; the page sees multiples of its own letters."""
FORMULA = re.compile(
    r'<(?P<tag>span|div) class="arithmatex">\\[\(\[](?P<latex>.*?)\\[\)\]]</(?P=tag)>', re.DOTALL
)
NUMBER = re.compile(r"\\tag\{([^}]*)\}")
ziamath.config.svg2 = False
ziamath.config.precision = 2


def with_formulas(html: str) -> str:
    r"""Return a page with its formulas drawn.

    Examples
    --------
    >>> html = r'<p><span class="arithmatex">\(x_1\)</span></p>'
    >>> with_formulas(html)
    '<p><span class="formula"><svg ...aria-label="x_1"...</svg></span></p>'
    """
    return FORMULA.sub(_drawn, html)


def _drawn(found: re.Match[str]) -> str:
    latex = unescape(found["latex"]).strip()
    if found["tag"] == "span":
        return f'<span class="formula">{_svg(latex, inline=True)}</span>'
    numbers = NUMBER.findall(latex)
    number = f'<span class="number">({numbers[0]})</span>' if numbers else ""
    picture = _svg(NUMBER.sub("", latex).strip(), inline=False)
    return f'<div class="formula"><span>{picture}</span>{number}</div>'


@cache
def _svg(latex: str, *, inline: bool) -> str:
    drawing = ziamath.Latex(latex, size=SIZE, color="currentColor", inline=inline)
    picture = drawing.svgxml()
    width, height = (float(picture.attrib[side]) / SIZE for side in ("width", "height"))
    _, top, _, tall = map(float, picture.attrib["viewBox"].split())
    picture.attrib |= {
        "width": f"{width:.3f}em",
        "height": f"{height:.3f}em",
        "style": f"vertical-align:{-(top + tall) / SIZE:.3f}em",
        "role": "img",
        "aria-label": latex,
    }
    return ElementTree.tostring(picture, encoding="unicode")
