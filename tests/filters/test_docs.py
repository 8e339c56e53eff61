"""The pages that people read are run: the ten lines of choose-a-filter, and the skeleton of add-a-filter."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

from filters.conformance import CHECKS
from muybridge.filters import METHODS, Method, method_from_module

DOCS = Path(__file__).parents[2] / "docs"


def code_of(page: str) -> str:
    """The page's first python block."""
    found = re.search(r"```python\n(.*?)```", (DOCS / page).read_text(encoding="utf-8"), re.DOTALL)
    assert found, f"{page} has lost its example"
    return found[1]


def test_the_ten_lines_run() -> None:
    exec(compile(code_of("choose-a-filter.md"), "choose-a-filter.md", "exec"), {"__name__": "example"})


@pytest.fixture(scope="module")
def skeleton() -> Iterator[Method]:
    """The skeleton's code as a module, made a row as a new filter would be."""
    module = ModuleType("jittered_filter_of_the_docs")
    sys.modules[module.__name__] = module  # dataclasses look their module up by name
    exec(compile(code_of("add-a-filter.md"), "add-a-filter.md", "exec"), module.__dict__)
    yield method_from_module("jittered", module, "the documentation's skeleton")
    del sys.modules[module.__name__]


@pytest.mark.parametrize("check", CHECKS, ids=lambda check: check.__name__.removeprefix("check_"))
def test_the_skeleton_conforms(skeleton: Method, check) -> None:
    check(skeleton)


def test_the_skeleton_keeps_to_the_layout() -> None:
    """The parts of a filter file's docstring, and its public names."""
    text = code_of("add-a-filter.md")
    for part in ("Paper:", "symbol", "Differences from the paper:", "Cost:"):
        assert part in text
    names = re.findall(r"^(?:class |def )?(\w+)", text, re.MULTILINE)
    assert {"init", "step", "Config", "PRINTED", "WORKING"} <= set(names)


@pytest.mark.parametrize("name", METHODS)
def test_every_filter_is_in_the_page(name: str) -> None:
    assert f"`{name}`" in (DOCS / "choose-a-filter.md").read_text(encoding="utf-8")
