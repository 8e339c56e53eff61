"""One page about a run: `write_report(folder, truth=None)` makes report.html.

| module | what |
|---|---|
| `content` | what is read from a run folder |
| `sheets` | contact sheets from overlay videos, cut to the person |
| `trouble` | which frames deserve a look |
| `figures` | the drawings, light and dark |
| `sections` | the parts of the page |
| `page` | HTML templates and the style sheet |
| `plots` | the drawings as PNG files |
| `write` | `write_report`, `render` |
"""

from muybridge.report.content import RunContent, gather
from muybridge.report.trouble import Trouble, find_trouble
from muybridge.report.write import render, write_report

__all__ = ["RunContent", "Trouble", "find_trouble", "gather", "render", "write_report"]
