"""The renderer against closed forms: a sphere's outline, a plane's depth, Lambert's cosine; kernels against twins."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge._kernels.rasterise import blend_skin, empty_buffers, fill_triangles, resolve, vertex_normals
from muybridge.cameras.model import Camera
from muybridge.synthetic.rasterise import Cloth, Layer, Mesh, coverage_of, draw
from reference.meshes import sphere
from reference.rasterise import resolved

GREY = Cloth(np.full((1, 2, 2, 2, 3), 100.0, dtype=np.float32), np.array([1.0]))


def straight_camera(focal: float = 500.0, distortion: tuple[float, ...] = (0, 0, 0, 0, 0)) -> Camera:
    """A camera at the origin whose axes are the world's."""
    matrix = np.array([[focal, 0, 319.5], [0, focal, 239.5], [0, 0, 1.0]])
    return Camera("straight", (640, 480), matrix, np.array(distortion, dtype=float), np.eye(3), np.zeros(3))


def drawn(camera, vertices, faces, **settings) -> Layer:
    normals = np.empty_like(vertices)
    vertex_normals(vertices, faces, normals)
    labels = np.zeros(len(faces), dtype=np.int32)
    return draw(camera, Mesh(vertices, normals, faces, vertices, labels, labels), GREY, **settings)


class TestSphere:
    """A sphere of radius r at distance d on the axis has the outline of a circle of radius f r / sqrt(d^2 - r^2)."""

    radius, distance, focal = 0.4, 2.5, 500.0

    def outline(self) -> float:
        return self.focal * self.radius / np.sqrt(self.distance**2 - self.radius**2)

    def test_area(self):
        layer = drawn(straight_camera(), *sphere(self.radius, np.array([0, 0, self.distance])))
        # The border crosses about 2 pi R pixels, sampled 2 x 2: the error of the area is below a tenth of its length.
        assert abs(layer.coverage.sum() - np.pi * self.outline() ** 2) < 0.1 * 2 * np.pi * self.outline()

    def test_outline_to_half_a_pixel(self):
        layer = drawn(straight_camera(), *sphere(self.radius, np.array([0, 0, self.distance])), samples=4)
        rows, columns = np.nonzero(layer.coverage >= 0.5)
        reach = np.hypot(columns + layer.window[0] - 319.5, rows + layer.window[1] - 239.5)
        assert abs(reach.max() - self.outline()) < 0.5

    def test_a_wrong_radius_fails(self):
        layer = drawn(straight_camera(), *sphere(1.02 * self.radius, np.array([0, 0, self.distance])))
        assert abs(layer.coverage.sum() - np.pi * self.outline() ** 2) > 0.1 * 2 * np.pi * self.outline()

    def test_nearest_depth(self):
        layer = drawn(straight_camera(), *sphere(self.radius, np.array([0, 0, self.distance])))
        # The faces are chords: they lie inside the sphere by up to r (1 - cos(pi / 192)).
        assert layer.depth.min() == pytest.approx(self.distance - self.radius, abs=self.radius * (np.pi / 192) ** 2)

    def test_brightest_towards_the_light(self):
        layer = drawn(
            straight_camera(),
            *sphere(self.radius, np.array([0, 0, self.distance])),
            light=np.array([-1, 0, -1.0]),
            ambient=0.0,
        )
        inside = layer.coverage == 1
        bright = np.where(inside, layer.colours[..., 0], 0)
        # Towards (-1, 0, -1) the cosine is 1 and the colour the cloth's own.
        assert bright.max() == pytest.approx(100.0, abs=0.2)
        assert np.unravel_index(bright.argmax(), bright.shape)[1] < layer.coverage.shape[1] / 3


class TestPlane:
    """A plane n . X = c is seen in the direction r at the depth c / (n . r)."""

    normal, level = np.array([0.3, -0.2, -1.0]), -3.0

    def quad(self):
        x, y = np.array([-1.0, 1, 1, -1]), np.array([-0.8, -0.8, 0.8, 0.8])
        z = (self.level - self.normal[0] * x - self.normal[1] * y) / self.normal[2]
        return np.stack([x, y, z], axis=1), np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)

    def test_depth(self):
        camera = straight_camera()
        layer = drawn(camera, *self.quad(), samples=1)
        rows, columns = np.nonzero(np.isfinite(layer.depth))
        rays = camera.pixel_to_camera(
            np.stack([columns + layer.window[0], rows + layer.window[1]], axis=1).astype(float)
        )
        expected = self.level / (rays @ self.normal)
        assert len(rows) > 10_000
        np.testing.assert_allclose(layer.depth[rows, columns], expected, rtol=1e-6)  # float32 holds 1/z to 6e-8

    def test_no_hole_between_the_triangles(self):
        layer = drawn(straight_camera(), *self.quad())
        middle = layer.coverage[20:-20, 20:-20]
        assert (middle[:, middle.shape[1] // 3 : -middle.shape[1] // 3] == 1).all()

    @pytest.mark.parametrize("order", [(0, 1), (1, 0)])
    def test_the_nearer_hides_the_farther(self, order):
        near = np.array([[-0.2, -0.2, 2], [0.2, -0.2, 2], [0, 0.3, 2.0]])
        far = near * (3, 3, 1.5)
        faces = np.array([[0, 1, 2], [3, 4, 5]], dtype=np.int32)[list(order)]
        layer = drawn(straight_camera(), np.concatenate([near, far]), faces, samples=1)
        at = 239 - layer.window[1], 319 - layer.window[0]
        assert layer.depth[at] == pytest.approx(2.0)


class TestLens:
    """Distortion moves the vertices, so a small thing lies where its middle is projected."""

    @pytest.mark.parametrize("place", [(0.9, 0.5, 2.0), (-1.0, 0.6, 2.2), (0.0, -0.8, 2.0)])
    def test_place(self, place):
        camera = straight_camera(distortion=(-0.2, 0.05, 1e-3, -1e-3, 0))
        layer = drawn(camera, *sphere(0.03, np.array(place), 48), samples=4)
        y, x = np.indices(layer.coverage.shape)
        total = layer.coverage.sum()
        middle = np.array([(x * layer.coverage).sum(), (y * layer.coverage).sum()]) / total + layer.window[:2]
        # Perspective moves the middle of a sphere's picture by (r / z)^2 of its distance from the axis: 0.1 px.
        assert np.abs(middle - camera.world_to_pixel(np.array(place))).max() < 0.25

    def test_behind_the_camera(self):
        layer = drawn(straight_camera(), *sphere(0.3, np.array([0, 0, -2.0]), 24))
        assert layer.coverage.sum() == 0

    def test_outside_the_picture(self):
        layer = drawn(straight_camera(), *sphere(0.3, np.array([9.0, 0, 2.0]), 24))
        assert layer.coverage.sum() == 0


class TestRegions:
    """Labels from the atlas are crisp lines that do not care about the mesh: here the colour changes in mid-face."""

    def square(self, regions: np.ndarray) -> Mesh:
        vertices = np.array([[-0.5, -0.5, 2], [0.5, -0.5, 2], [0.5, 0.5, 2], [-0.5, 0.5, 2.0]])
        faces = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
        uv = (vertices[:, :2] + 0.5).astype(np.float32)
        normals = np.tile([0.0, 0.0, -1.0], (4, 1))
        labels, parts = np.full(2, -1, dtype=np.int32), np.zeros(2, dtype=np.int32)
        return Mesh(vertices, normals, faces, vertices, labels, parts, uv[faces], regions)

    cloth = Cloth(np.full((2, 2, 2, 2, 3), [[[[[50.0]]]], [[[[200.0]]]]], dtype=np.float32), np.ones(2))

    def test_hem(self):
        """f x / z with f = 500, z = 2: texel 16 of 64 begins at x = -0.25, 62.5 pixels left of the middle."""
        regions = np.zeros((64, 64), dtype=np.uint8)
        regions[:, 16:] = 1
        layer = draw(straight_camera(), self.square(regions), self.cloth, samples=1)
        row = layer.colours[layer.colours.shape[0] // 2, :, 0]
        bright = row > row[row > 0].mean()
        edge = layer.window[0] + np.flatnonzero(bright)[0] - 0.5
        assert abs(edge - (319.5 - 0.25 * 500 / 2)) <= 0.5
        assert len(np.unique(row[row > 0].round(3))) == 2

    def test_rows_run_along_v(self):
        regions = np.zeros((64, 64), dtype=np.uint8)
        regions[:8] = 1
        layer = draw(straight_camera(), self.square(regions), self.cloth, samples=1)
        column = layer.colours[:, layer.colours.shape[1] // 2, 0]
        assert (column > column[column > 0].mean()).sum() == pytest.approx(500 / 2 / 8, abs=1)


class TestTwins:
    @pytest.mark.parametrize("samples", [1, 2, 3])
    def test_resolve(self, samples):
        rng = np.random.default_rng(8)
        pixels, inverse = rng.uniform(-5, 35, (30, 2)), rng.uniform(0.2, 1, 30)
        faces = rng.integers(0, 30, (40, 3)).astype(np.int32)
        buffers = empty_buffers(7 * samples, 5 * samples)
        fill_triangles(pixels, inverse, faces, *buffers)
        normals = rng.normal(size=(30, 3))
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        labels = rng.integers(-1, 3, 40).astype(np.int32)
        uv, regions = rng.uniform(0, 1, (40, 3, 2)).astype(np.float32), rng.integers(0, 3, (9, 11)).astype(np.uint8)
        parts = rng.integers(0, 20, 40).astype(np.int32)
        tiles, sizes = rng.uniform(0, 255, (3, 4, 4, 4, 3)).astype(np.float32), rng.uniform(0.2, 2, 3)
        given = (faces, normals, rng.normal(size=(30, 3)), labels, uv, regions, parts, tiles, sizes)
        light = np.array([0.6, 0.0, 0.8])
        out = [np.empty((5, 7, *more), dtype=kind) for more, kind in (((), "f4"), ((3,), "f4"), ((), "f4"), ((), "i2"))]
        resolve(*buffers, *given, light, 0.4, *out)
        for fast, slow in zip(out, resolved(*buffers, *given, light, 0.4), strict=True):
            # Single precision; a texture's cell, found from rounded numbers, may be the next one in a pixel or two.
            close = np.isclose(fast, slow, rtol=1e-4, atol=1e-3) | (fast == slow)
            assert (~close).mean() < 0.02

    def test_fill_triangles(self):
        rng = np.random.default_rng(5)
        pixels, inverse = rng.uniform(-5, 35, (30, 2)), rng.uniform(0.2, 1, 30)
        faces = rng.integers(0, 30, (40, 3)).astype(np.int32)
        buffers = empty_buffers(30, 24)
        fill_triangles(pixels, inverse, faces, *buffers)
        depth, face = _fill_literally(pixels, inverse, faces, 30, 24)
        np.testing.assert_allclose(buffers[0], depth, rtol=1e-5)
        # Where two faces meet within rounding either may win.
        assert (buffers[1] == face).mean() > 0.99

    def test_faces_without_pixels_are_left_out(self):
        pixels = np.array([[0, 0], [10, 0], [0, 10], [np.nan, np.nan]])
        buffers = empty_buffers(12, 12)
        fill_triangles(pixels, np.array([1, 1, 1, -1.0]), np.array([[0, 1, 3]], dtype=np.int32), *buffers)
        assert (buffers[1] == -1).all()

    def test_coverage_of_a_square(self):
        points = np.array([[1.5, 1.5], [6.5, 1.5], [6.5, 4.5], [1.5, 4.5]])
        covered = coverage_of(points, np.array([[0, 1, 2], [0, 3, 2]], dtype=np.int32), 10, 8)
        assert covered.sum() == 5 * 3 and covered[2:5, 2:7].all()

    def test_blend_skin(self):
        rng = np.random.default_rng(1)
        rest, weights = rng.normal(size=(50, 3)), rng.dirichlet(np.ones(4), 50)
        indices = rng.integers(0, 6, (50, 4)).astype(np.int32)
        turns, offsets = rng.normal(size=(6, 3, 3)), rng.normal(size=(6, 3))
        out = np.empty((50, 3))
        blend_skin(rest, weights, indices, turns, offsets, out)
        each = np.einsum("vkij,vj->vki", turns[indices], rest) + offsets[indices]
        np.testing.assert_allclose(out, np.einsum("vk,vki->vi", weights, each), atol=1e-12)

    def test_normals_of_a_sphere(self):
        vertices, faces = sphere(2.0, np.zeros(3), 96)
        normals = np.empty_like(vertices)
        vertex_normals(vertices, faces, normals)
        away = np.abs(vertices[:, 2]) < 1.98  # the poles are 96 vertices in one place
        np.testing.assert_allclose(normals[away], vertices[away] / 2, atol=(2 * np.pi / 96))


def _fill_literally(pixels, inverse, faces, width, height):
    """Every pixel against every face, with barycentric coordinates from a linear system."""
    depth, owner = np.zeros((height, width)), np.full((height, width), -1)
    for y in range(height):
        for x in range(width):
            for index, face in enumerate(faces):
                corners = np.vstack([pixels[face].T, np.ones(3)])
                if abs(np.linalg.det(corners)) < 1e-9:
                    continue
                weights = np.linalg.solve(corners, [x, y, 1])
                if (weights >= 0).all() and weights @ inverse[face] > depth[y, x]:
                    depth[y, x], owner[y, x] = weights @ inverse[face], index
    return depth, owner
