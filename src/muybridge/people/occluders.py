from __future__ import annotations
import numpy as np

def find_occluders(masks, ground, least=6, share=0.12, reach=0.6):
    import cv2
    heat = np.zeros(masks[0].shape, np.float32)
    for m in masks:
        heat += m
    heat = cv2.blur(heat, (3, 3))
    height, width = heat.shape
    hidden = np.zeros(heat.shape, bool)
    for row in range(height):
        size = int(reach * float(ground.height(np.array([row + 0.3 * ground.height(np.array([row]))[0]]))[0])) | 1
        line = heat[row : row + 1]
        closed = cv2.morphologyEx(line, cv2.MORPH_CLOSE, np.ones((1, size), np.uint8))
        hidden[row] = ((closed >= least) & (line <= share * closed))[0]
    return cv2.morphologyEx(hidden.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8)).astype(bool)
