"""Articulated bodies: the model, reading and writing it as text, the catalogue.

=================  =====================================================
Body               a tree of segments; poses -> frames, joints
named_body         a body of the catalogue, at a height
read_body          a body from a TOML file; write_body the way back
catalogue          the names there are
=================  =====================================================
"""

from muybridge.body.arrays import BodyArrays
from muybridge.body.load import catalogue, named_body, parse_body, read_body
from muybridge.body.model import Body
from muybridge.body.parts import Landmark, Rotation, Segment, Shape
from muybridge.body.save import dump_body, write_body

__all__ = [
    "Body",
    "BodyArrays",
    "Landmark",
    "Rotation",
    "Segment",
    "Shape",
    "catalogue",
    "dump_body",
    "named_body",
    "parse_body",
    "read_body",
    "write_body",
]
