"""The page: plain string templates, everything that is text escaped, everything that is a picture inside."""

from __future__ import annotations

from html import escape
from string import Template

PAGE = Template("""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>$title</title>
<style>$style</style>
</head>
<body>
<main>
$body
</main>
<footer>$footer</footer>
</body>
</html>
""")

STYLE = """
:root { --surface: #ffffff; --ink: #1d2126; --muted: #616a75; --line: #e3e7eb; --tile: #f6f8f9;
  --good: #00775a; --bad: #b3123f; --left: #0072b2; }
@media (prefers-color-scheme: dark) { :root { --surface: #16191d; --ink: #e9edf1; --muted: #9aa4af; --line: #2c3238;
  --tile: #1e2227; --good: #2fc79a; --bad: #ff7a96; --left: #56b4e9; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--surface); color: var(--ink); line-height: 1.5;
  font: 16px/1.5 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, sans-serif; }
main, footer { max-width: 62rem; margin: 0 auto; padding: 0 1.25rem; }
header { padding: 2.5rem 0 0.5rem; }
h1 { font-size: 1.75rem; line-height: 1.2; margin: 0 0 0.25rem; letter-spacing: -0.01em; overflow-wrap: anywhere; }
h2 { font-size: 1.15rem; margin: 2.5rem 0 0.5rem; padding-top: 1rem; border-top: 1px solid var(--line); }
h3 { font-size: 0.95rem; margin: 1.25rem 0 0.4rem; }
p { margin: 0.4rem 0; max-width: 46rem; }
.quiet, figcaption, footer { color: var(--muted); font-size: 0.875rem; }
.status { display: inline-block; padding: 0.05rem 0.6rem; border-radius: 1rem; font-size: 0.8rem; font-weight: 600;
  border: 1px solid currentColor; vertical-align: 0.3rem; margin-left: 0.5rem; }
.good { color: var(--good); } .bad { color: var(--bad); }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(9rem, 1fr)); gap: 0.75rem; margin: 1.25rem 0; }
.tile { background: var(--tile); border-radius: 0.6rem; padding: 0.75rem 0.9rem; }
.tile b { display: block; font-size: 1.5rem; font-weight: 600; line-height: 1.25; font-variant-numeric: tabular-nums; }
.tile span { color: var(--muted); font-size: 0.8rem; display: block; }
figure { margin: 0.75rem 0 1.25rem; }
img { max-width: 100%; height: auto; display: block; }
figure > img { border-radius: 0.4rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: 0.875rem; font-variant-numeric: tabular-nums; width: 100%; }
th, td { text-align: left; padding: 0.3rem 0.9rem 0.3rem 0; border-bottom: 1px solid var(--line); vertical-align: top; }
th { color: var(--muted); font-weight: 500; }
td.number, th.number { text-align: right; }
details { margin: 0.75rem 0; } summary { cursor: pointer; color: var(--left); }
pre { background: var(--tile); border-radius: 0.6rem; padding: 0.9rem; overflow-x: auto; font-size: 0.8rem; line-height:
1.45; } footer { padding-top: 1.5rem; padding-bottom: 2.5rem; }
@media print { .tile, pre { border: 1px solid var(--line); } details:not([open]) { display: none; } }
"""


def page(heading: str, body: str, footer: str) -> str:
    """The whole file. `body` is HTML; heading and footer are text."""
    return PAGE.substitute(title=escape(heading), style=STYLE, body=body, footer=escape(footer))


def section(heading: str, *parts: str) -> str:
    """A part of the page under a heading; nothing where it would be empty."""
    filled = [part for part in parts if part]
    return f"<section>\n<h2>{escape(heading)}</h2>\n" + "\n".join(filled) + "\n</section>" if filled else ""


def paragraph(text: str, *, quiet: bool = False) -> str:
    """A paragraph of text."""
    return f'<p class="quiet">{escape(text)}</p>' if quiet else f"<p>{escape(text)}</p>"


def tiles(values: list[tuple[str, str]]) -> str:
    """Figures to see at a glance: (value, what it is)."""
    cells = "".join(
        f'<div class="tile"><b>{escape(value)}</b><span>{escape(label)}</span></div>' for value, label in values
    )
    return f'<div class="tiles">{cells}</div>'


def figure(content: str, caption: str) -> str:
    """A picture's HTML with its caption."""
    return f"<figure>{content}<figcaption>{escape(caption)}</figcaption></figure>"


def table(header: list[str], rows: list[list[str]], numbers: set[int] | None = None) -> str:
    """A table of text; the columns in `numbers` are set flush right."""

    def line(cells: list[str], tag: str) -> str:
        """A row of the table; tag is td or th."""
        kinds = [' class="number"' if i in (numbers or set()) else "" for i in range(len(cells))]
        return (
            "<tr>"
            + "".join(f"<{tag}{kind}>{escape(cell)}</{tag}>" for cell, kind in zip(cells, kinds, strict=True))
            + "</tr>"
        )

    body = "\n".join(line(row, "td") for row in rows)
    return f'<div class="scroll"><table><thead>{line(header, "th")}</thead><tbody>\n{body}\n</tbody></table></div>'


def folded(summary: str, text: str) -> str:
    """Text that opens on demand, as it stands."""
    return f"<details><summary>{escape(summary)}</summary><pre>{escape(text)}</pre></details>"
