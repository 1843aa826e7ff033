#!/usr/bin/env python3
"""Writes a small recording of a world (MCAP) for the rows of the table of causes: two sites, alice and bob, and ten states in ten seconds.

    make_world_recording.py FILE.mcap [--foreign]     with --foreign: topics of another program
"""

import struct
import sys
import zlib

MAGIC = b"\x89MCAP0\r\n"
BEGIN_NS = 1_700_000_000_000_000_000


def record(opcode, *parts):
    content = b"".join(parts)
    return struct.pack("<BQ", opcode, len(content)) + content


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def cdr(*parts):
    """The parts behind each other, each at a multiple of its alignment; the header counts for nothing."""
    out = b""
    for alignment, data in parts:
        out += b"\0" * (-len(out) % alignment) + data
    return b"\0\1\0\0" + out


def name(value):
    return 4, struct.pack("<I", len(value) + 1) + value.encode() + b"\0"


def description(site):
    return cdr(name(site), (4, struct.pack("<I", 0)), (8, struct.pack("<6d", -1, -1, 0, 1, 1, 2)))


def state(tick):
    return cdr(name("w"), (8, struct.pack("<Qq", tick, BEGIN_NS)), (4, struct.pack("<I", 0)))


def main():
    file, is_foreign = sys.argv[1], "--foreign" in sys.argv
    topics = ["/robot/pose", "/robot/state"] if is_foreign else ["SiteDescription", "SceneState"]
    messages = [(0, 0.0, description("alice")), (0, 0.0, description("bob"))] + [(1, 1.0 * i, state(i)) for i in range(11)]
    data = MAGIC + record(1, text(""), text("test"))
    summary = b"".join(record(4, struct.pack("<HH", number, 0), text(topic), text("cdr"), text("")) for number, topic in enumerate(topics))
    records = b""
    for number, (channel, seconds, payload) in enumerate(messages):
        ns = BEGIN_NS + int(seconds * 1e9)
        records += record(5, struct.pack("<HIQQ", channel, number, ns, ns), payload)
    times = struct.pack("<QQ", BEGIN_NS, BEGIN_NS + 10_000_000_000)
    data += summary
    chunk_at = len(data)
    sizes = struct.pack("<Q", len(records))
    data += record(6, times, sizes, struct.pack("<I", zlib.crc32(records)), text(""), sizes, records)
    chunk = struct.pack("<QQ", chunk_at, len(data) - chunk_at)
    data += record(0x0F, struct.pack("<I", 0))
    summary_at = len(data)
    counts = struct.pack("<IHQHQ", 20, 0, 2, 1, 11)
    summary += record(0x0B, struct.pack("<QHIIII", len(messages), 0, 2, 0, 0, 1), times, counts)
    summary += record(8, times, chunk, struct.pack("<I", 0), struct.pack("<Q", 0), text(""), sizes, sizes)
    footer = struct.pack("<BQQQ", 2, 20, summary_at, 0)
    data += summary + footer + struct.pack("<I", zlib.crc32(summary + footer)) + MAGIC
    with open(file, "wb") as stream:
        stream.write(data)


if __name__ == "__main__":
    main()
