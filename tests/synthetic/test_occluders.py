"""Things in the way: closed boxes, drawn where they are, hiding what is behind and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.synthetic.occluders import Occluder, cloth_of, hides, mesh_of
from muybridge.synthetic.rasterise import Layer, draw
from muybridge.synthetic.rigs import looking_at

CRATE = Occluder("box", (0.4, -0.3), (0.6, 0.4, 1.0), turn=0.5)
CAMERA = looking_at("a", np.array([4.0, 0.0, 1.2]), np.array([0.0, 0.0, 0.6]), focal=150, size=(160, 120))


def drawn(thing: Occluder) -> Layer:
    return draw(CAMERA, mesh_of([thing]), cloth_of(np.random.default_rng(0), [thing]))


@pytest.mark.parametrize("thing", [CRATE, Occluder("table", size=(1.2, 0.7, 0.74))])
@pytest.mark.parametrize("cell", [0.06, 0.3, np.inf])
def test_volume_and_normals(thing: Occluder, cell: float) -> None:
    """The divergence theorem: faces that run counter-clockwise seen from outside give the volume, exactly."""
    mesh = mesh_of([thing], cell)
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    volume = np.einsum("fi,fi->", a, np.cross(b, c)) / 6
    assert volume == pytest.approx(sum(size.prod() for _, size in thing.boxes()), rel=1e-9)
    outward = np.cross(b - a, c - a)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    np.testing.assert_allclose(outward, mesh.normals[mesh.faces[:, 0]], atol=1e-9)


def test_it_stands_where_it_says() -> None:
    vertices = mesh_of([CRATE]).vertices
    np.testing.assert_allclose(0.5 * (vertices.min(axis=0) + vertices.max(axis=0)), [0.4, -0.3, 0.5], atol=1e-9)
    assert vertices[:, 2].min() == pytest.approx(0) and vertices[:, 2].max() == pytest.approx(1.0)


def test_depth_of_a_wall() -> None:
    """A box square to the camera's path: on its front side camera z is that of the plane x = 0.25.

    A pixel keeps the nearest of its samples, 0.25 pixel off its centre: 0.25 / 150 of the depth times the slope of the
    plane in the picture, tan of the camera's 8.5 degrees down, 0.001 m at 3.75 m.
    """
    wall = Occluder("box", (0.0, 0.0), (0.5, 3.0, 2.0))
    layer = drawn(wall)
    left, top, _, _ = layer.window
    y, x = np.nonzero(layer.coverage == 1)
    places = CAMERA.pixel_to_camera(np.stack([x + left, y + top], axis=1).astype(float), layer.depth[y, x])
    world = CAMERA.camera_to_world(places)
    front = world[:, 2] < 1.95  # the top side is seen too, at a slant
    assert front.sum() > 2000
    np.testing.assert_allclose(world[front, 0], 0.25, atol=0.002)


def test_hides_is_what_the_renderer_hides() -> None:
    """Points of a plane behind the crate are hidden where the crate's layer covers their pixel, but for its edge."""
    points = np.random.default_rng(3).uniform([-1.5, -1.5, 0.0], [-1.5, 1.5, 1.9], (2000, 3))
    layer = drawn(CRATE)
    covered = np.zeros((120, 160), dtype=np.float32)
    left, top, right, bottom = layer.window
    covered[top:bottom, left:right] = layer.coverage
    x, y = np.round(CAMERA.world_to_pixel(points)).astype(int).T
    inside = (x >= 0) & (x < 160) & (y >= 0) & (y < 120)
    hidden, share = hides(CRATE, CAMERA.position, points)[inside], covered[y[inside], x[inside]]
    clear = (share == 0) | (share == 1)
    # A whole or empty pixel has no edge nearer than its samples, 0.25 pixel; its corners, 0.7 off, may still differ.
    assert hidden.sum() > 100 and (hidden[clear] == (share[clear] == 1)).mean() > 0.99


def test_nothing_in_front_is_hidden() -> None:
    points = np.array([[3.0, 0.0, 0.6], [2.0, -0.2, 0.5]])
    assert not hides(CRATE, CAMERA.position, points).any()


def test_distance() -> None:
    thing = Occluder("box", (1.0, 0.0), (0.4, 2.0, 1.0), turn=np.pi / 2)
    np.testing.assert_allclose(thing.distance(np.array([[1.0, 0.0], [1.0, 0.7], [3.0, 1.2]])), [0, 0.5, np.sqrt(2)])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"kind": "sofa"}, "one of box, table"),
        ({"pattern": "tartan"}, "one of plain"),
        ({"size": (1.0, 0.0, 1.0)}, "three positive lengths"),
        ({"place": (np.nan, 0.0)}, "finite numbers"),
    ],
)
def test_bad_input(change: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        Occluder(**change)
