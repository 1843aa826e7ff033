#!/usr/bin/env python3
"""Compares two pictures of a person: compare_views.py BLENDER.png VIEWER.png [BESIDE.png]

Prints the peak signal to noise ratio inside the silhouette of the first one, which has a transparent background, two pixels from its
outline on. BESIDE.png gets both pictures side by side, and their difference.
"""
import sys

import numpy as np
from PIL import Image

blender = np.asarray(Image.open(sys.argv[1]).convert("RGBA")).astype(float)
viewer = np.asarray(Image.open(sys.argv[2]).convert("RGB")).astype(float)
inside = blender[..., 3] >= 255
for _ in range(2):
    inside = inside & np.roll(inside, 1, 0) & np.roll(inside, -1, 0) & np.roll(inside, 1, 1) & np.roll(inside, -1, 1)
difference = (blender[..., :3] - viewer)[inside]
error = np.mean(difference**2)
print(f"{10 * np.log10(255**2 / error):.1f} dB, {inside.sum()} pixels, mean difference {np.abs(difference).mean():.1f}, "
      f"offset {difference.mean(0).round(1)}")
if len(sys.argv) > 3:
    shown = np.where(inside[..., None], np.abs(blender[..., :3] - viewer) * 4, 0).clip(0, 255)
    flat = np.where(blender[..., 3:] > 0, blender[..., :3], 128)
    rows, columns = np.where(inside)
    part = (slice(max(0, rows.min() - 20), rows.max() + 20), slice(max(0, columns.min() - 20), columns.max() + 20))
    Image.fromarray(np.hstack([flat[part], viewer[part], shown[part]]).astype(np.uint8)).save(sys.argv[3])
