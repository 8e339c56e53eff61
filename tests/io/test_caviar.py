"""CAVIAR's XML: boxes about a centre; entities are not expanded; bad files in one line."""

from __future__ import annotations

from pathlib import Path

import pytest

from conftest import shared_data
from muybridge.errors import InputError
from muybridge.io.boxes import read_boxes
from muybridge.io.caviar import read_caviar

CAVIAR = """<?xml version="1.0" encoding="UTF-8"?>
<dataset name="made">
 <frame number="0"><objectlist>
  <object id="3"><orientation>90</orientation><box xc="50" yc="40" w="20" h="30"/><appearance>appear</appearance>
   <body><head xc="50" yc="28" size="5" evaluation="1"/></body>
   <hypothesislist><hypothesis id="1" prev="1.0"><movement>walking</movement></hypothesis></hypothesislist>
  </object>
  <object id="1"><box h="8" w="4" xc="10.5" yc="20"/></object>
 </objectlist>
 <grouplist><group id="0"><box xc="1" yc="1" w="2" h="2"/><members>1,3</members></group></grouplist></frame>
 <frame number="1"><objectlist/><grouplist/></frame>
 <frame number="2"><objectlist><object id="3"><box xc="51" yc="40" w="20" h="30"/></object></objectlist></frame>
</dataset>
"""


def test_objects_count_and_groups_do_not(tmp_path: Path) -> None:
    (tmp_path / "made.xml").write_text(CAVIAR)
    read = read_boxes(tmp_path / "made.xml")
    assert read.frames.tolist() == [0, 0, 2] and read.ids.tolist() == [1, 3, 3]
    assert read.boxes.tolist() == [[8.5, 16, 4, 8], [40, 25, 20, 30], [41, 25, 20, 30]]
    assert read.confidence.tolist() == [1, 1, 1]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("not xml", "XML"),
        (CAVIAR[:-200], "XML"),
        ("<dataset></dataset>", "none in <dataset>"),
        (CAVIAR.replace('w="20"', 'w="wide"', 1), "a number for w"),
        (CAVIAR.replace('xc="50" yc="40" w', 'yc="40" w', 1), "a number for xc"),
        (CAVIAR.replace('id="3"', 'id="1.5"', 1), "a whole number for id"),
        (CAVIAR.replace('number="2"', 'number="-2"'), "from 0"),
        (CAVIAR.replace('<object id="1">', '<object id="3">'), "twice"),
        ('<!DOCTYPE d [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;">]><d>&b;</d>', "DOCTYPE"),
        ('<!DOCTYPE d SYSTEM "file:///etc/hostname"><d/>', "DOCTYPE"),
    ],
)
def test_bad_files_are_one_line(tmp_path: Path, text: str, words: str) -> None:
    (tmp_path / "bad.xml").write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        read_caviar(tmp_path / "bad.xml")
    assert "bad.xml" in str(caught.value) and "\n" not in str(caught.value)


def test_no_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="none.xml"):
        read_caviar(tmp_path / "none.xml")


def test_the_annotations_of_pets() -> None:
    """4650 boxes and 19 people over 795 frames, as its description says."""
    read = read_caviar(shared_data("pets2009_s2l1") / "annotations" / "PETS2009-S2L1.xml")
    assert (len(read), len(set(read.ids)), read.frames.min(), read.frames.max()) == (4650, 19, 0, 794)
    first = read.between(0, 0)
    assert first.ids.tolist() == [9, 15, 19]
    assert first.boxes[0].tolist() == pytest.approx([514.7109 - 31.03 / 2, 195.2731 - 75.17 / 2, 31.03, 75.17])
