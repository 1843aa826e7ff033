"""A segmentation worker for sites of Atrium: background difference with OpenCV (docs/segmentation_worker.md).

An example to start from: it shows how a segmentation of your own is plugged in. The built-in segmentation copes better with shadows and
changing light.
"""

import argparse
import sys

try:
    import cv2
    import numpy
    import atrium_segmentation
except ImportError as error:
    sys.exit(f"error: {error}; install it with: sudo apt install python3-opencv")

EDGE_PX = 9  # how far people move between two pictures
SHADOW = (0.5, 1.1)  # what shadow and reflected light make of the brightness of a surface


def difference(picture, background):
    """The largest difference of the three colours, without single pixels of noise."""
    blue, green, red = cv2.split(cv2.absdiff(picture, background))
    return cv2.medianBlur(cv2.max(cv2.max(blue, green), red), 3)


def without_shadows(distance, picture, background, weak):
    """The difference, 0 where it is weak or where another brightness of the same surface explains it."""
    here = picture.astype(numpy.float32)
    room = background.astype(numpy.float32)
    sum_of_colours = numpy.ones((1, 3), numpy.float32)
    light = cv2.transform(here * room, sum_of_colours) / (cv2.transform(room * room, sum_of_colours) + 1.0)
    rest = difference(here, room * numpy.clip(light, *SHADOW)[:, :, None])
    return numpy.where((distance > weak) & (rest > weak), distance, 0).astype(numpy.uint8)


def people(distance, last_mask, strong):
    """The parts with a difference that hold a strong one, or that were people a moment ago."""
    candidates = cv2.morphologyEx(cv2.compare(distance, 0, cv2.CMP_GT), cv2.MORPH_CLOSE, numpy.ones((7, 7), numpy.uint8))
    core = cv2.erode(last_mask, numpy.ones((EDGE_PX, EDGE_PX), numpy.uint8))
    num, parts = cv2.connectedComponents(candidates)
    has_seed = numpy.zeros(num, numpy.uint8)
    has_seed[parts[(distance > strong) | (core > 0)]] = 255
    has_seed[0] = 0  # not a candidate
    return cv2.blur(has_seed[parts], (3, 3))


def segment(picture, background, last_mask, weak, strong):
    """Returns the alpha. Most of the work is done only around what differs from the empty room."""
    alpha = numpy.zeros(last_mask.shape, numpy.uint8)
    distance = difference(picture, background)
    x, y, width, height = cv2.boundingRect(cv2.compare(distance, weak, cv2.CMP_GT))
    if width > 0:
        box = numpy.s_[y : y + height, x : x + width]
        alpha[box] = people(without_shadows(distance[box], picture[box], background[box], weak), last_mask[box], strong)
    return alpha


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("socket", help="path of the socket to serve at: segmentation.worker of the site")
    parser.add_argument("--weak", type=int, default=14, help="least difference of a person [grey levels] (default: %(default)s)")
    parser.add_argument("--strong", type=int, default=40, help="difference that some part of a person has (default: %(default)s)")
    parser.add_argument("--parallel", action="store_true", help="segment the pictures of several cameras at the same time")
    parser.add_argument("--mode", type=lambda text: int(text, 8), default=0o600, help="rights on the socket (default: 600, you alone)")
    given = parser.parse_args()
    if given.parallel:
        cv2.setNumThreads(1)  # the cameras share the cores

    def make(_camera):
        return lambda picture, background, last_mask: segment(picture, background, last_mask, given.weak, given.strong)

    try:
        atrium_segmentation.serve(given.socket, make, given.parallel, given.mode)
    except atrium_segmentation.WorkerError as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
