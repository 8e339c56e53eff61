"""thin."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from muybridge.people.detect import detect
from muybridge.people.box import BoxMotion, CountConfig, boxes_from_states, overlaps
from muybridge.people.colour_likelihood import ColourConfig
from muybridge.people.evidence import Evidence, ForegroundConfig, Silhouette
from muybridge.people.ground import GroundScale
from muybridge.people.histograms import to_luma_chroma
from muybridge.people.person import Frame, Person, follow, start


@dataclass(frozen=True, kw_only=True)
class TrackerConfig:
    colour: ColourConfig = ColourConfig(spread=0.6)
    foreground: ForegroundConfig = ForegroundConfig()
    counts: CountConfig = CountConfig()
    confirm: int = 4
    patience: int = 8
    patience_hidden: int = 25
    least: float = 0.45
    smallest: float = 45.0
    clear: float = 0.1


class PeopleTracker:
    def __init__(self, picture_size, background, ground, config=None, seed=0, hidden=None, silhouette=None):
        self.config = config or TrackerConfig()
        self.size, self.ground = picture_size, ground
        self.background = to_luma_chroma(background)
        self.motion = BoxMotion.within(picture_size)
        self.rng = np.random.default_rng(seed)
        self.people: list[Person] = []
        self.gone: list[Person] = []
        self.count = 0
        self.hidden_mask = hidden
        self.silhouette = silhouette or Silhouette.flat()

    def step(self, number, picture, mask):
        cfg = self.config
        frame = Frame(to_luma_chroma(picture), self.background, Evidence(mask, cfg.foreground, self.silhouette, self.hidden_mask))
        order = sorted(self.people, key=lambda p: (not p.confirmed, -(p.box[1] + p.box[5] + p.box[3] / 2)))
        for i, p in enumerate(order):
            behind = [q.box + np.r_[q.box[4:], 0, 0, 0, 0] for q in order[i + 1 :]]
            follow(self.rng, p, frame, self.motion, self.ground, cfg.counts, behind)
            self._judge(p)
            p.track.append((number, p.box.copy(), p.visible * p.filled))
            if not p.unseen:
                frame.evidence.explain(p.box)
        self._doubles()
        for p in list(self.people):
            limit = cfg.patience_hidden if p.visible < 0.4 else cfg.patience
            if not p.confirmed:
                limit = 1
            if p.unseen + p.hidden > limit or self.ground.height(p.box[1:2] + p.box[3] / 2)[0] < 0.95 * cfg.smallest:
                self.people.remove(p)
                self.gone.append(p)
        self._births(number, frame, mask)

    def _doubles(self):
        P = self.people
        if len(P) < 2:
            return
        b = boxes_from_states(np.array([p.box for p in P]))
        o = overlaps(b, b) - np.eye(len(P))
        worst = o.max(axis=1)
        for p, w in zip(P, worst):
            p.doubled = p.doubled + 1 if w > 0.6 else 0
        for i, p in enumerate(list(P)):
            j = int(o[i].argmax())
            q = P[j]
            if p in self.people and q in self.people and p is not q and o[i, j] > 0.6 and min(p.doubled, q.doubled) > (10 if p.confirmed and q.confirmed else 2):
                loser = min((p, q), key=lambda r: (r.confirmed, r.seen))
                loser.unseen = max(loser.unseen, loser.doubled)
                self.people.remove(loser)
                self.gone.append(loser)
                break

    def _judge(self, p):
        if p.visible < 0.3:
            p.hidden += 1
        elif p.filled < 0.2:
            p.unseen += 1
        else:
            p.seen += 1
            p.unseen = p.hidden = 0
            p.confirmed |= p.seen >= self.config.confirm

    def _births(self, number, frame, mask):
        cfg = self.config
        weights = frame.evidence.weights
        for p in self.people:
            l, t, w, h = boxes_from_states(p.box[None])[0]
            l, t, w, h = l - cfg.clear * w, t - cfg.clear * h, (1 + 2 * cfg.clear) * w, (1 + 2 * cfg.clear) * h
            weights[max(0, round(t)) : max(0, round(t + h)), max(0, round(l)) : max(0, round(l + w))] = 0
        for box, score in detect(mask, weights, self.silhouette, cfg.foreground.outside, self.ground, cfg.least, smallest=cfg.smallest):
            self.count += 1
            p = start(self.rng, self.count, number, box, frame, self.motion, cfg.colour)
            p.track.append((number, box.copy(), 1.0))
            self.people.append(p)

    def finish(self):
        rows = []
        for p in self.gone + self.people:
            if not p.confirmed:
                continue
            tr = p.track[: len(p.track) - p.unseen - p.hidden] if (p.unseen + p.hidden) else p.track
            rows += [(n, p.identity, *boxes_from_states(b[None])[0], s) for n, b, s in tr]
        return np.array(rows)
