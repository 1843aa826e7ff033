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


def difference(picture, background):
    """The largest difference of the three colours, without single pixels of noise."""
    channels = cv2.split(cv2.absdiff(picture, background))
    return cv2.medianBlur(cv2.max(cv2.max(channels[0], channels[1]), channels[2]), 3)


def segment(picture, background, last_mask, weak, strong):
    """Returns the alpha: the parts with a weak difference that hold a strong one, or that were people a moment ago."""
    distance = difference(picture, background)
    _, candidates = cv2.threshold(distance, weak, 255, cv2.THRESH_BINARY)
    candidates = cv2.morphologyEx(candidates, cv2.MORPH_CLOSE, numpy.ones((5, 5), numpy.uint8))
    core = cv2.erode(last_mask, numpy.ones((EDGE_PX, EDGE_PX), numpy.uint8))
    seeds = cv2.bitwise_or(cv2.compare(distance, strong, cv2.CMP_GT), cv2.bitwise_and(core, candidates))
    # which parts have a seed: at half the size, in a quarter of the time
    half = (picture.shape[1] // 2, picture.shape[0] // 2)
    num, parts = cv2.connectedComponents(cv2.resize(candidates, half, interpolation=cv2.INTER_NEAREST))
    has_seed = numpy.zeros(num, numpy.uint8)
    has_seed[parts[cv2.resize(seeds, half, interpolation=cv2.INTER_NEAREST) > 0]] = 255
    has_seed[0] = 0  # not a candidate
    people = cv2.dilate(has_seed[parts], numpy.ones((3, 3), numpy.uint8))
    people = cv2.bitwise_and(candidates, cv2.resize(people, candidates.shape[::-1], interpolation=cv2.INTER_NEAREST))
    return cv2.blur(people, (3, 3))


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
