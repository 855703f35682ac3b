"""Writing figures: SVG small enough to stand inside a page, taking its colours and font from it; PNG for everything else."""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

from flexstage.base.text import printable
from flexstage.show.figures.style import ABOUT, ALONG, DRIVE, GAUGE, GRID, INK, MUTED, PAPER, style_context

_NUMBER = re.compile(r"-?\d+\.\d+(?:e-?\d+)?")
_PATH = re.compile(r'<path([^>]*?) d="([^"]*)"([^>]*)>')
_STRAIGHT = re.compile(r"[MLz\d.\s-]+")
_STEP = re.compile(r"([MLz])\s*(?:(-?[\d.]+)\s+(-?[\d.]+))?")
_GEOMETRY = re.compile(r'(?<=\s)(x|y|x1|x2|y1|y2|width|height|transform|points|viewBox)="([^"]*)"')
_GROUP = re.compile(r"<g>([^<]*(?:<(?!/?g\b)[^<]*)*)</g>")
_STYLE = re.compile(r' style="([^"]+)"')
_MARKS = re.compile(
    r'<use href="#(?P<mark>[^"]+)" x="[^"]*" y="[^"]*"(?P<look>[^>]*)/>(?:<use href="#(?P=mark)" x="[^"]*" y="[^"]*"(?P=look)/>){2,}'
)
_PLACE = re.compile(r' x="([^"]*)" y="([^"]*)"')
_PICTURE = re.compile(r"<svg .*?</svg>", re.DOTALL)
_SHEET = re.compile(r"<style>([^<]*)</style>")
_RULE = re.compile(r"\.([\w-]+)(\{[^}]*\})")
_CLASS = re.compile(r' class="([\w-]+)"(?=[^<>]*>)')
_REFERENCE = re.compile(r'(?: id="|href="#|url\(#)([\w-]+)(?=[^<>]*>)')
SCENERY = "scenery"
"""Artists with this `gid` say their own `markup`, which comes under everything else of a figure."""

_THEME = {INK: "ink", MUTED: "muted", GRID: "rule", PAPER: "paper", DRIVE: "drive", GAUGE: "gauge", ALONG: "along", ABOUT: "about"}


def to_svg(figure: Any, name: str, description: str) -> str:
    """The figure as an SVG element to stand inside a page; `name` keeps its identifiers apart from those of other figures.

    The same figure always gives the same text. Colours of ink, rules and paper are the page's variables, with the style's own as default.
    `description` is read to those who cannot see the picture.

    >>> from flexstage.show.figures.style import canvas
    >>> to_svg(canvas(1.0, 1.0), "empty", "nothing")[:33]
    '<svg viewBox="0 0 72 72" role="im'
    """
    from flexstage.show.figures.ruler import ruled  # loads matplotlib

    buffer = io.StringIO()
    scenery = [each for axes in figure.axes for each in axes.artists if each.get_gid() == SCENERY]
    with style_context(), ruled(figure):
        for each in scenery:
            each.set_visible(False)
        figure.savefig(buffer, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
        for each in scenery:
            each.set_visible(True)
    opening, start, rest = compact_svg(buffer.getvalue(), name, description).partition(">")
    return opening + start + "".join(each.markup(f"{name}-{number}") for number, each in enumerate(scenery)) + rest


def to_png(figure: Any, *, dots_per_inch: int = 160) -> bytes:
    """The figure as PNG on white.

    >>> from flexstage.show.figures.style import canvas
    >>> to_png(canvas(1.0, 1.0))[1:4]
    b'PNG'
    """
    buffer = io.BytesIO()
    with style_context():
        figure.savefig(buffer, format="png", dpi=dots_per_inch, facecolor="white", metadata={"Software": None})
    return buffer.getvalue()


def share_styles(page: str) -> tuple[str, str]:
    """A page of HTML whose pictures of `to_svg` share one style sheet, which comes beside it: equal rules once, all names short.

    >>> one, other = (f'<svg ><style>.{name}-0{{fill:red}}</style><path class="{name}-0"/></svg>' for name in ("first", "second"))
    >>> share_styles(one + other)
    ('<svg ><path class="_0"/></svg><svg ><path class="_0"/></svg>', '._0{fill:red}')
    """
    classes: dict[str, str] = {}
    names: dict[str, str] = {}

    def shared(found: re.Match[str]) -> str:
        rules = [rule for sheet in _SHEET.findall(found[0]) for rule in _RULE.findall(sheet)]
        own = {name: classes.setdefault(rule, f"_{len(classes)}") for name, rule in rules}
        text = _CLASS.sub(lambda tag: f' class="{own.get(tag[1], tag[1])}"', _SHEET.sub("", found[0]))
        return _REFERENCE.sub(lambda tag: tag[0].replace(tag[1], names.setdefault(tag[1], f"_{len(names)}")), text)

    told = _PICTURE.sub(shared, page)
    return told, "".join(f".{name}{rule}" for rule, name in classes.items())


def theme_colour(colour: str) -> str:
    """A colour as the page's variable, where it has one.

    >>> theme_colour("#b9c2cc"), theme_colour(INK)
    ('#b9c2cc', 'var(--ink,#1f2a37)')
    """
    return f"var(--{_THEME[colour]},{colour})" if colour in _THEME else colour


def compact_svg(text: str, name: str, description: str) -> str:
    """matplotlib's SVG without header, metadata, unused identifiers and digits nobody sees; repeated styles become classes.

    >>> compact_svg('<?xml version="1.0"?><svg width="72pt" viewBox="0 0 72 72"><g id="a"><path d="M 1.23456 2"/></g></svg>', "f", "a path")
    '<svg viewBox="0 0 72 72" role="img" aria-label="a path" style="--width:96px;max-width:96px"><path d="M1.2 2"/></svg>'
    """
    body = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->|<\?xml.*?\?>|<!DOCTYPE.*?>", "", text, flags=re.DOTALL)
    body = body[body.index("<svg") :].replace("xlink:href", "href")
    view = re.search(r'viewBox="([^"]*)"', body)
    box = view[1] if view else "0 0 100 100"
    body = re.sub(r"<svg[^>]*>", "", body, count=1).removesuffix("\n").removesuffix("</svg>")
    # matplotlib's own rule would reach the whole page.
    body = re.sub(r"<style type=.text/css.>.*?</style>", "", body, flags=re.DOTALL)
    body = re.sub(r' transform="rotate\(-?0(?:\.0)? [^"]*\)"', "", body)
    body = _prefix_ids(body, name)
    body = _PATH.sub(_path, body)
    body = _GEOMETRY.sub(lambda found: f'{found[1]}="{_shorten_numbers(found[2])}"', body)
    body = _STYLE.sub(lambda found: f' style="{_styling(found[1])}"', body)
    body = _drop_empty(re.sub(r">\s+<", "><", body))
    body, classes = _classes(_join_marks(body), name)
    size = [float(each) for each in box.split()[2:]]
    return printable(f"{head(size, description)}{classes}{body.strip()}</svg>", keep="\n\t")


def head(size: Sequence[float], description: str) -> str:
    """How a picture of that size [pt] begins; `description` is read to those who cannot see it.

    >>> head((72.0, 36.0), "a < b")
    '<svg viewBox="0 0 72 36" role="img" aria-label="a &lt; b" style="--width:96px;max-width:96px">'
    """
    width = round(float(size[0]) * 96.0 / 72.0)
    box = " ".join(_round(f"{float(each):f}", 1) for each in (0.0, 0.0, *size))
    return f'<svg viewBox="{box}" role="img" aria-label="{_attribute(description)}" style="--width:{width}px;max-width:{width}px">'


def _attribute(text: str) -> str:
    for sign, entity in (("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ('"', "&quot;")):
        text = text.replace(sign, entity)
    return text


def _prefix_ids(body: str, name: str) -> str:
    """Identifiers that are referred to get the figure's name in front, the others go."""
    used = set(re.findall(r'(?:url\(#|href="#)([^)"]+)', body))
    body = re.sub(r' id="([^"]+)"', lambda found: f' id="{name}-{found[1]}"' if found[1] in used else "", body)
    return re.sub(r'(url\(#|href="#)([^)"]+)', rf"\g<1>{name}-\g<2>", body)


def _shorten_numbers(numbers: str, decimals: int = 1) -> str:
    """Numbers to a tenth of a point, without zeros that say nothing."""
    text = _NUMBER.sub(lambda found: _round(found[0], decimals), numbers)
    text = re.sub(r"\s+", " ", text).strip()
    return re.sub(r"(?<=[A-Za-z]) (?=[-\d])| (?=[A-Za-z])", "", text) if text[:1] == "M" else text


def _path(found: re.Match[str]) -> str:
    """A path with fewer digits; translucent areas keep one more, or their seams show."""
    decimals = 2 if "fill-opacity" in found[3] else 1
    text = found[2].replace("\n", " ")
    outline = _to_relative(text, decimals) if _STRAIGHT.fullmatch(text) else _shorten_numbers(text, decimals)
    return f'<path{found[1]} d="{outline}"{found[3]}>'


def _to_relative(text: str, decimals: int) -> str:
    """A path of straight lines with steps instead of points; a line that goes on from the last point needs no new start."""
    scale = 10**decimals
    here: tuple[int, int] | None = None
    pieces: list[str] = []
    drawing = False
    for sign, x, y in _STEP.findall(text):
        if not x:
            pieces.append("z")
            here = None
            continue
        point = (round(float(x) * scale), round(float(y) * scale))
        if sign == "L" and here is not None:
            pieces.append(_step("" if drawing else "l", point[0] - here[0], point[1] - here[1], decimals))
            drawing = True
        elif point != here:
            pieces.append(f"M{_decimal(point[0], decimals)} {_decimal(point[1], decimals)}")
            drawing = False
        here = point
    return "".join(pieces)


def _step(sign: str, across: int, up: int, decimals: int) -> str:
    first, second = _decimal(across, decimals), _decimal(up, decimals)
    start = sign or ("" if first.startswith("-") else " ")
    return f"{start}{first}{'' if second.startswith('-') else ' '}{second}"


@lru_cache(maxsize=1 << 12)
def _decimal(value: int, decimals: int) -> str:
    """An integer number of units of the last decimal, as short as it goes.

    >>> _decimal(-5, 1), _decimal(120, 1)
    ('-.5', '12')
    """
    text = f"{value / 10**decimals:.{decimals}f}".rstrip("0").rstrip(".")
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


def _round(number: str, decimals: int) -> str:
    text = f"{float(number):.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


@lru_cache(maxsize=256)
def _styling(style: str) -> str:
    """A style with the page's colours and font, without blanks."""
    style = re.sub(r"font: (?:(bold|\d+) )?([\d.]+)px [^;]+", _font, style)
    for colour in _THEME:
        style = style.replace(colour, theme_colour(colour))
    style = re.sub(r"stroke-linejoin: \w+;? ?|font-family: [^;]+;? ?", "", style)
    if "fill-opacity" in style:
        style += "; shape-rendering: crispEdges"  # or the seams between neighbours show
    style = _NUMBER.sub(lambda found: f"{float(found[0]):.2f}".rstrip("0").rstrip("."), style)
    return style.replace(": ", ":").replace("; ", ";").rstrip("; ")


def _font(found: re.Match[str]) -> str:
    weight = f"; font-weight: {found[1]}" if found[1] else ""
    return f"font-size: {found[2]}px{weight}"


def _drop_empty(body: str) -> str:
    """Groups without attributes unwrapped, empty ones removed."""
    before = ""
    while before != body:
        before = body
        body = _GROUP.sub(r"\1", body)
        body = re.sub(r"<defs>\s*</defs>|<defs/>|<g/>", "", body)
    return body


def _join_marks(body: str) -> str:
    """Runs of equal marks as one path, at whose points they stand; their look is the mark's own."""
    numbers: dict[tuple[str, str], int] = {}

    def path(found: re.Match[str]) -> str:
        key, first = (found["mark"], found["look"]), (found["mark"], found["look"]) not in numbers
        name = f"{found['mark']}-{numbers.setdefault(key, len(numbers))}"
        mark = f'<use href="#{found["mark"]}"{found["look"]}/>'
        made = f'<marker id="{name}" overflow="visible" markerUnits="userSpaceOnUse">{mark}</marker>' if first else ""
        points = " ".join(f"{x} {y}" for x, y in _PLACE.findall(found[0]))
        return f'{made}<path d="M{points}" style="fill:none;marker:url(#{name})"/>'

    return _MARKS.sub(path, body)


def _classes(body: str, name: str) -> tuple[str, str]:
    """Styles used more than twice become classes of a style sheet of the figure's own, but for those that refer to something of it."""
    counts: dict[str, int] = {}
    for style in _STYLE.findall(body):
        counts[style] = counts.get(style, 0) + 1
    common = [style for style, count in counts.items() if count > 2 and "url(#" not in style]
    names = {style: f"{name}-{number}" for number, style in enumerate(common)}
    body = _STYLE.sub(lambda found: f' class="{names[found[1]]}"' if found[1] in names else found[0], body)
    rules = "".join(f".{names[style]}{{{style}}}" for style in common)
    return body, f"<style>{rules}</style>" if rules else ""
