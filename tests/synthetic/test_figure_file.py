"""The baked files: cuts, hair and shoes are what their names say, and hems are level."""

from __future__ import annotations

import numpy as np
import pytest

from muybridge.errors import InputError
from muybridge.synthetic.figure_file import HAIR, cut_names
from muybridge.synthetic.skinning import Figure, load_figure


def texel_labels(figure: Figure, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Labels and places (F, 3) at rest of one point of each face that the region map labels."""
    faces = figure.face_labels < 0
    uv = np.einsum("k,fki->fi", share, figure.corner_uv[faces])
    column, row = np.minimum((uv * figure.regions.shape[::-1]).astype(int).T, figure.regions.shape[0] - 1)
    return figure.regions[row, column], np.einsum("k,fki->fi", share, figure.vertices[figure.faces[faces]])


def reach(figure: Figure, label: str) -> float:
    """Share of the body's surface that a label covers."""
    corners = figure.vertices[figure.faces[figure.face_labels < 0]]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    worn = texel_labels(figure, np.full(3, 1 / 3))[0] == figure.label_names.index(label)
    return float(area[worn].sum() / area.sum())


class TestErrors:
    def test_figure(self):
        with pytest.raises(InputError, match="figure: expected one of child, heavy_man, man, .*, got 'nobody'"):
            load_figure("nobody")

    def test_what_all_share_is_nobody(self):
        with pytest.raises(InputError, match="figure"):
            load_figure("common")

    def test_cut(self):
        with pytest.raises(InputError, match="figure: cut: expected one of short_sleeves, .*, got 'toga'"):
            load_figure("man", cut="toga")

    def test_hair(self):
        with pytest.raises(InputError, match="figure: hair: expected one of short, long, bun, got 'mohawk'"):
            load_figure("man", hair="mohawk")


class TestCuts:
    figures = {cut: load_figure("man", cut=cut) for cut in cut_names()}

    def test_long_sleeves_cover_more_than_short_ones(self):
        # Both forearms without the hands are 6 % of the body's surface; two of these cuts differ by them.
        shirts = {cut: reach(figure, "shirt") for cut, figure in self.figures.items()}
        assert shirts["long_sleeves"] - shirts["short_sleeves"] > 0.03
        assert self.figures["short_sleeves"].cut == "short_sleeves"

    def test_shorts_bare_the_shanks(self):
        # Both shanks are 13 % of the body's surface.
        trousers = {cut: reach(figure, "trousers") for cut, figure in self.figures.items()}
        assert trousers["long_sleeves"] - trousers["shorts"] > 0.09

    def test_only_a_skirt_has_a_skirt(self):
        counts = {cut: len(figure.vertices) for cut, figure in self.figures.items()}
        assert counts["skirt"] > counts["shorts"] == counts["long_sleeves"] == counts["short_sleeves"]

    @pytest.mark.parametrize("cut, lower", [("short_sleeves", 0.0), ("long_sleeves", 0.0), ("shorts", -0.08)])
    def test_hems_are_level(self, cut, lower):
        """On the trunk shirt and trousers meet at one height at rest, to a texel (4 mm) and the cloth's tilt (3 mm)."""
        figure = self.figures[cut]
        hem = figure.heads[figure.bone("abdomen"), 2] + 0.02 + lower
        rng = np.random.default_rng(6)
        for share in rng.dirichlet(np.ones(3), 20):
            labels, places = texel_labels(figure, share)
            trunk = np.isin(figure.face_parts[figure.face_labels < 0], [0, 1, 2])
            shirt, trousers = (figure.label_names.index(name) for name in ("shirt", "trousers"))
            assert places[trunk & (labels == shirt), 2].min() > hem - 0.008
            assert places[trunk & (labels == trousers), 2].max() < hem + 0.008

    def test_looseness_is_zero_on_bare_skin(self):
        for figure in self.figures.values():
            bare = np.isin(figure.labels, [figure.label_names.index(name) for name in ("skin", "eyes", "shoes")])
            assert figure.looseness[bare].max() == 0


class TestHair:
    figures = {hair: load_figure("woman", hair=hair) for hair in HAIR}

    def test_long_hair_reaches_below_the_neck(self):
        lowest = {}
        for hair, figure in self.figures.items():
            worn = figure.labels == figure.label_names.index("hair")
            lowest[hair] = figure.vertices[worn, 2].min() - figure.heads[figure.bone("neck"), 2]
        assert lowest["long"] < -0.1 < 0 < lowest["short"]

    def test_a_bun_stands_out_behind(self):
        back = {}
        for hair, figure in self.figures.items():
            head = figure.bone_indices[:, 0] == figure.bone("head")
            back[hair] = figure.vertices[head, 0].min()
        assert back["bun"] < back["short"] - 0.04


class TestShoes:
    @pytest.mark.parametrize("name", ["man", "child", "old_woman"])
    def test_soles_are_flat_and_round_the_foot(self, name):
        """A sole's vertices lie on the floor or at its edge, 18 mm higher; bare skin is 5 mm inside the shoe."""
        figure = load_figure(name)
        worn = figure.face_labels == figure.label_names.index("soles")
        heights = figure.vertices[np.unique(figure.faces[worn]), 2]
        assert heights.min() == pytest.approx(0, abs=1e-6) and heights.max() < 0.018 + 0.004
        shoes = figure.labels == figure.label_names.index("shoes")
        ankle = figure.heads[figure.bone("left_foot"), 2]
        low = figure.vertices[shoes & (figure.vertices[:, 2] < 0.5 * ankle)]
        assert np.ptp(low[low[:, 1] > 0, 0]) > 0.13 * figure.landmarks["head_top"][2]
