"""Lets a segmentation of your own find the people in the pictures of an Atrium site (docs/segmentation_worker.md).

    import atrium_segmentation

    def make(camera):                                   # once per camera: name, width, height
        def segment(picture, background, last_mask):    # once per picture
            return alpha                                # height x width; people are 255
        return segment

    atrium_segmentation.serve("/run/user/1000/atrium-worker", make)

Needs Python 3.9 and numpy.
"""

import contextlib
import ctypes
import mmap
import os
import signal
import socket
import stat
import struct
import sys
import threading
import time
import traceback

import numpy

VERSION = 1
MAGIC = b"ATRMSEGM"
HEADER = struct.Struct("<8sIIQIIQQQQII64s")
SITE_MESSAGE = struct.Struct("<IIQqII")  # kind, version, number, capture time [ns], background, 0
WORKER_MESSAGE = struct.Struct("<IIQII")  # kind, version, number, width, height
HELLO, PICTURE = 1, 2
READY, ALPHA, NONE = 1, 2, 3
BETWEEN_COMPLAINTS_S = 10.0


class WorkerError(Exception):
    """What keeps a worker from serving; its text is for the user."""


class Camera:
    """One camera of a site. The last three change with each picture.

    name: as in the site's rig. width, height: of its pictures [px]. deadline_s: the site waits so long for an alpha.
    number: of the picture. capture_time_ns: on the site's clock, since 1970. background_number: grows when the background changes.
    """

    def __init__(self, descriptor):
        num_bytes = os.fstat(descriptor).st_size
        if num_bytes < HEADER.size:
            raise WorkerError("the site's memory is too small")
        at_once = getattr(mmap, "MAP_POPULATE", 0)  # else the first picture is late
        memory = mmap.mmap(descriptor, num_bytes, mmap.MAP_SHARED | at_once)
        (magic, version, _, told_bytes, self.width, self.height, background, picture, last_mask, alpha, deadline_us, _,
         name) = HEADER.unpack_from(memory)
        if magic != MAGIC:
            raise WorkerError("this is no site of Atrium")
        if version != VERSION:
            raise WorkerError(f"the site speaks version {version} of the protocol, this worker version {VERSION}")
        if told_bytes != num_bytes:
            raise WorkerError("the site's memory has another size than it says")
        self.name = name.rstrip(b"\0").decode("utf-8", "replace")
        self.deadline_s = deadline_us / 1e6
        self.number = self.capture_time_ns = self.background_number = 0

        def plane(offset, *channels):
            shape = (self.height, self.width, *channels)
            return numpy.ndarray(shape, numpy.uint8, memory, offset)

        self._background = plane(background, 3)
        self._picture = plane(picture, 3)
        self._last_mask = plane(last_mask)
        self._alpha = plane(alpha)
        for array in (self._background, self._picture, self._last_mask):
            array.flags.writeable = False


def _as_bytes(alpha, camera):
    """The alpha as numpy.uint8; from truth values and from floats in [0, 1] too."""
    alpha = numpy.asarray(alpha)
    if alpha.shape != (camera.height, camera.width):
        raise WorkerError(f"segment returned an alpha of the shape {alpha.shape}, not {(camera.height, camera.width)}")
    if alpha.dtype == numpy.uint8:
        return alpha
    if alpha.dtype == numpy.bool_:
        return alpha.astype(numpy.uint8) * 255
    if numpy.issubdtype(alpha.dtype, numpy.floating):
        return (numpy.clip(alpha, 0.0, 1.0) * 255.0 + 0.5).astype(numpy.uint8)
    raise WorkerError(f"segment returned an alpha of {alpha.dtype}; uint8, bool or float are right")


class _Complaints:
    """Prints what goes wrong with pictures, seldom enough to be read."""

    def __init__(self):
        self._next = 0.0

    def tell(self):
        now = time.monotonic()
        if now >= self._next:
            self._next = now + BETWEEN_COMPLAINTS_S
            traceback.print_exc()


def _say(text):
    print(text, file=sys.stderr, flush=True)


def _serve_camera(connection, make, lock):
    data, descriptors, _, _ = socket.recv_fds(connection, 256, 1)
    if not data:
        return  # it only looked whether somebody serves
    if not descriptors:
        raise WorkerError("a program connected that is no site of Atrium")
    try:
        if len(data) != SITE_MESSAGE.size or SITE_MESSAGE.unpack(data)[0] != HELLO:
            raise WorkerError("a program connected that does not speak the protocol")
        camera = Camera(descriptors[0])
    finally:
        for descriptor in descriptors:
            os.close(descriptor)
    with lock:
        segment = make(camera)
    connection.send(WORKER_MESSAGE.pack(READY, VERSION, 0, camera.width, camera.height))
    _say(f"camera {camera.name}: {camera.width}x{camera.height} px, {1e3 * camera.deadline_s:g} ms for each picture")
    complaints = _Complaints()
    while True:
        data = connection.recv(256)
        if not data:
            break
        kind, _, camera.number, camera.capture_time_ns, camera.background_number, _ = SITE_MESSAGE.unpack(data)
        if kind != PICTURE:
            raise WorkerError(f"the site sent a message of kind {kind}")
        answer = ALPHA
        try:
            with lock:
                alpha = segment(camera._picture, camera._background, camera._last_mask)
            numpy.copyto(camera._alpha, _as_bytes(alpha, camera))
        except Exception:  # of the user's code: this picture has no alpha, the next one may
            complaints.tell()
            answer = NONE
        connection.send(WORKER_MESSAGE.pack(answer, VERSION, camera.number, camera.width, camera.height))
    _say(f"camera {camera.name}: the site is gone")


def _serve_connection(connection, make, lock):
    with connection:
        try:
            _serve_camera(connection, make, lock)
        except WorkerError as error:
            _say(f"error: {error}")
        except OSError as error:
            _say(f"the site is gone: {error}")
        except Exception:  # of `make`
            traceback.print_exc()


def _listen(path, mode):
    """A socket at `path`. Replaces that of a worker which has ended."""
    if os.path.exists(path):
        if not stat.S_ISSOCK(os.stat(path).st_mode):
            raise WorkerError(f"{path}: is there already, and no socket")
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as former:
            try:
                former.connect(path)
            except ConnectionRefusedError:
                os.unlink(path)
            except OSError as error:
                raise WorkerError(f"{path}: {error.strerror}") from error
            else:
                raise WorkerError(f"{path}: another worker serves there")
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    mask = os.umask(0o777 & ~mode)
    try:
        listener.bind(path)
    except OSError as error:
        listener.close()
        raise WorkerError(f"{path}: {error.strerror or error}") from error
    finally:
        os.umask(mask)
    listener.listen(64)
    return listener


def _keep_memory():
    """Lets the C library keep freed memory. Else each picture maps that of its arrays anew, which takes longer than the work on them."""
    trim_threshold, mmap_threshold = -1, -3  # of malloc.h
    with contextlib.suppress(OSError, AttributeError):  # another C library
        library = ctypes.CDLL(None)
        library.mallopt(trim_threshold, 1 << 30)
        library.mallopt(mmap_threshold, 32 << 20)


def _interrupt(_signal, _frame):
    raise KeyboardInterrupt


def serve(path, make, parallel=False, mode=0o600):
    """Serves the sites that connect to the socket `path`, until Ctrl-C or SIGTERM.

    make(camera) is called once for each camera that connects. It returns segment(picture, background, last_mask), which is called for each
    picture: BGR (height x width x 3), BGR, and 0 or 255 per pixel (height x width), all numpy.uint8. They are read-only, and valid during
    the call only. It returns the alpha, height x width: uint8 (from 128 on a person), bool, or float from 0 to 1. If it raises, the picture
    has none.

    One picture at a time is segmented. parallel: those of different cameras at the same time, each camera in its own thread. mode: rights on
    the socket; sites of other users need to write to it.
    """
    lock = contextlib.nullcontext() if parallel else threading.Lock()
    _keep_memory()
    listener = _listen(path, mode)
    own = os.stat(path).st_ino
    if threading.current_thread() is threading.main_thread():
        for ending in (signal.SIGINT, signal.SIGTERM):  # a shell that starts it in the background lets it ignore the first
            signal.signal(ending, _interrupt)
    _say(f"serving at {path}; Ctrl-C ends")
    try:
        while True:
            connection, _ = listener.accept()
            threading.Thread(target=_serve_connection, args=(connection, make, lock), daemon=True).start()
    except KeyboardInterrupt:
        pass
    finally:
        listener.close()
        with contextlib.suppress(OSError):
            if os.stat(path).st_ino == own:
                os.unlink(path)
