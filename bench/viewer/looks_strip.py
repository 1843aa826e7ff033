#!/usr/bin/env python3
"""Puts the pictures of looks_strip.sh side by side.

usage: looks_strip.py FOLDER VIEW PNG    FOLDER has LOOK-off and LOOK-round_photo, each with pictures of texture_quality
"""

import glob
import os
import sys

import cv2
import numpy

PANELS = 5  # of a picture of texture_quality: the true person, the viewer, then other ways
GREY = 128


def panels(folder, view):
    """The true person and the viewer's picture, at one free viewpoint."""
    found = glob.glob(os.path.join(folder, f"room*-{view:02}.png"))
    files = [file for file in found if " own" not in os.path.basename(file) and " full" not in os.path.basename(file)]
    if len(files) != 1:
        sys.exit(f"looks_strip: {folder} has {len(files)} pictures of view {view}, not one; VIEW is 0 to 19")
    picture = cv2.imread(files[0])
    width = picture.shape[1] // PANELS
    return picture[:, :width], picture[:, width:2 * width]


def main(folder, view, png):
    pictures = []
    for look in sorted({name.split("-")[0] for name in os.listdir(folder) if "-" in name}):
        true, before = panels(os.path.join(folder, look + "-off"), int(view))
        _, after = panels(os.path.join(folder, look + "-round_photo"), int(view))
        pictures += [true, before, after]
    height = max(picture.shape[0] for picture in pictures)
    pictures = [cv2.copyMakeBorder(picture, height - picture.shape[0], 0, 0, 0, cv2.BORDER_CONSTANT, value=(GREY,) * 3)
                for picture in pictures]
    if not cv2.imwrite(png, numpy.hstack(pictures), [cv2.IMWRITE_PNG_COMPRESSION, 9]):
        sys.exit(f"looks_strip: cannot write {png}")
    print(f"wrote {png}")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
