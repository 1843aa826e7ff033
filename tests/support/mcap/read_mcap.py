#!/usr/bin/env python3
"""Reads an MCAP file as its specification says (https://mcap.dev/spec), and checks all that it promises.

Written without a look at core/mcap, with Python's standard library and the system's libzstd and liblz4 only. As a program:
`read_mcap.py FILE` prints one line of JSON for each message, in the order of the file; an error goes to stderr, with exit code 1.
"""

import collections
import ctypes
import ctypes.util
import json
import struct
import sys
import zlib

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = 0x0B, 0x0C, 0x0D, 0x0E, 0x0F


class McapError(Exception):
    pass


def must(condition, what):
    if not condition:
        raise McapError(what)


class Fields:
    """Takes the fields of a record, one after the other."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, size):
        must(self.at + size <= len(self.data), "a record is shorter than its fields")
        self.at += size
        return self.data[self.at - size:self.at]

    def number(self, kind):
        return struct.unpack("<" + kind, self.take(struct.calcsize("<" + kind)))[0]

    def text(self):
        return self.take(self.number("I")).decode("utf-8")

    def pairs(self, first, second):
        inner, out = Fields(self.take(self.number("I"))), []
        while inner.at < len(inner.data):
            out.append((first(inner), second(inner)))
        return out

    def rest(self):
        return self.take(len(self.data) - self.at)


def texts(fields):
    return dict(fields.pairs(Fields.text, Fields.text))


def unzstd(data, size):
    library = ctypes.CDLL(ctypes.util.find_library("zstd") or "libzstd.so.1")
    library.ZSTD_decompress.restype = ctypes.c_size_t
    library.ZSTD_decompress.argtypes = [ctypes.c_void_p, ctypes.c_size_t, ctypes.c_char_p, ctypes.c_size_t]
    out = ctypes.create_string_buffer(size)
    must(library.ZSTD_decompress(out, size, data, len(data)) == size, "zstd: damaged")
    return out.raw


def decompress(method, data, size):
    must(method in ("", "zstd"), f"compression {method}")
    out = unzstd(data, size) if method == "zstd" else data
    must(len(out) == size, "a chunk has another size than it says")
    return out


Message = collections.namedtuple("Message", "topic channel sequence log_time publish_time data")


class Mcap:
    """All of a file: schemas {id: (name, encoding, data)}, channels {id: (schema, topic, encoding, metadata)}, messages, metadata."""

    def __init__(self, data):
        self.data = data
        self.schemas, self.channels, self.messages, self.metadata = {}, {}, [], []
        self.chunks = []  # (offset, length, first, last, compression, compressed size, size, {channel: offset of its index}, index length)
        self.metadata_places = []
        must(data[:8] == MAGIC, "no MCAP file")
        must(len(data) > 16 and data[-8:] == MAGIC, "it has no end")
        end = self.read_data()
        self.read_summary(end)

    def records(self, at, end, data=None):
        data = self.data if data is None else data
        while at < end:
            must(at + 9 <= end, "a record is cut off")
            opcode, length = struct.unpack_from("<BQ", data, at)
            must(opcode != 0, "opcode 0")
            must(at + 9 + length <= end, "a record is cut off")
            yield at, opcode, Fields(data[at + 9:at + 9 + length]), 9 + length
            at += 9 + length

    def read_data(self):
        first = True
        for at, opcode, fields, length in self.records(8, len(self.data) - 8):
            must(first == (opcode == HEADER), "the header is not the first record")
            first = False
            if opcode == HEADER:
                self.profile, self.library = fields.text(), fields.text()
            elif opcode == SCHEMA:
                self.add_schema(fields)
            elif opcode == CHANNEL:
                self.add_channel(fields)
            elif opcode == METADATA:
                self.metadata.append((fields.text(), texts(fields)))
                self.metadata_places.append((at, length))
            elif opcode == CHUNK:
                self.read_chunk(at, length, fields)
            elif opcode == MESSAGE_INDEX:
                self.read_index(at, length, fields)
            elif opcode == MESSAGE:
                self.add_message(fields)
            elif opcode == DATA_END:
                crc = fields.number("I")
                must(crc in (0, zlib.crc32(self.data[:at])), "the CRC of the data is wrong")
                return at + length
        raise McapError("it has no end of data")

    def add_schema(self, fields):
        number = fields.number("H")
        must(number != 0, "schema 0")
        schema = (fields.text(), fields.text(), fields.take(fields.number("I")))
        must(self.schemas.setdefault(number, schema) == schema, "two schemas of one number")

    def add_channel(self, fields):
        number = fields.number("H")
        channel = (fields.number("H"), fields.text(), fields.text(), texts(fields))
        must(channel[0] == 0 or channel[0] in self.schemas, "a channel in front of its schema")
        must(self.channels.setdefault(number, channel) == channel, "two channels of one number")

    def add_message(self, fields):
        channel, sequence = fields.number("H"), fields.number("I")
        must(channel in self.channels, "a message in front of its channel")
        log_time, publish_time = fields.number("Q"), fields.number("Q")
        self.messages.append(Message(self.channels[channel][1], channel, sequence, log_time, publish_time, fields.rest()))

    def read_chunk(self, at, length, fields):
        first, last, size, crc = fields.number("Q"), fields.number("Q"), fields.number("Q"), fields.number("I")
        method = fields.text()
        compressed = fields.take(fields.number("Q"))
        must(fields.rest() == b"", "a chunk has more than its records")
        records = decompress(method, compressed, size)
        must(crc in (0, zlib.crc32(records)), "the CRC of a chunk is wrong")
        self.places = collections.defaultdict(list)  # of the messages of this chunk, by channel
        begin = len(self.messages)
        for place, opcode, inner, _ in self.records(0, len(records), records):
            must(opcode in (SCHEMA, CHANNEL, MESSAGE), f"opcode {opcode} in a chunk")
            {SCHEMA: self.add_schema, CHANNEL: self.add_channel, MESSAGE: self.add_message}[opcode](inner)
            if opcode == MESSAGE:
                self.places[self.messages[-1].channel].append((self.messages[-1].log_time, place))
        times = [message.log_time for message in self.messages[begin:]] or [0]
        must((first, last) == (min(times), max(times)), "a chunk's times are wrong")
        self.chunks.append([at, length, first, last, method, len(compressed), size, {}, 0])

    def read_index(self, at, length, fields):
        must(self.chunks, "a message index in front of all chunks")
        channel = fields.number("H")
        places = fields.pairs(lambda inner: inner.number("Q"), lambda inner: inner.number("Q"))
        must(sorted(places) == sorted(self.places[channel]), "a message index is wrong")
        self.chunks[-1][7][channel] = at
        self.chunks[-1][8] += length

    def read_summary(self, begin):
        footer = len(self.data) - 8 - 29
        opcode, length, summary, offsets, crc = struct.unpack_from("<BQQQI", self.data, footer)
        must((opcode, length) == (FOOTER, 20), "the footer is not the last record")
        must(summary == begin, "the summary does not follow the data")
        must(crc == zlib.crc32(self.data[summary:footer + 25]), "the CRC of the summary is wrong")
        schemas, channels, chunks, places, groups = dict(self.schemas), dict(self.channels), [], [], collections.defaultdict(list)
        self.schemas, self.channels, statistics = {}, {}, None
        for at, opcode, fields, size in self.records(summary, offsets or footer):
            groups[opcode].append((at, size))
            if opcode == SCHEMA:
                self.add_schema(fields)
            elif opcode == CHANNEL:
                self.add_channel(fields)
            elif opcode == STATISTICS:
                statistics = [fields.number(kind) for kind in "QHIIIIQQ"]
                counts = dict(fields.pairs(lambda inner: inner.number("H"), lambda inner: inner.number("Q")))
            elif opcode == CHUNK_INDEX:
                first, last, offset, length = (fields.number("Q") for _ in range(4))
                indexes = dict(fields.pairs(lambda inner: inner.number("H"), lambda inner: inner.number("Q")))
                index_length, method = fields.number("Q"), fields.text()
                chunks.append([offset, length, first, last, method, fields.number("Q"), fields.number("Q"), indexes, index_length])
            elif opcode == METADATA_INDEX:
                places.append((fields.number("Q"), fields.number("Q")))
        must((schemas, channels) == (self.schemas, self.channels), "the summary has other schemas or channels than the data")
        must(chunks == self.chunks, "the chunk indexes are wrong")
        must(places == self.metadata_places, "the metadata indexes are wrong")
        times = [message.log_time for message in self.messages] or [0]
        must(statistics == [len(self.messages), len(schemas), len(channels), 0, len(self.metadata), len(chunks), min(times), max(times)],
             "the statistics are wrong")
        must(counts == dict(collections.Counter(message.channel for message in self.messages)), "the counts of messages are wrong")
        self.check_offsets(offsets, footer, groups)

    def check_offsets(self, offsets, footer, groups):
        if offsets == 0:
            return
        named = {}
        for _, opcode, fields, _ in self.records(offsets, footer):
            must(opcode == SUMMARY_OFFSET, "a record among the summary offsets")
            group = fields.number("B")
            named[group] = (fields.number("Q"), fields.number("Q"))
        found = {opcode: (records[0][0], sum(size for _, size in records)) for opcode, records in groups.items()}
        must(named == found, "the summary offsets are wrong")


def lines(mcap):
    for message in mcap.messages:
        yield json.dumps({"topic": message.topic, "channel": message.channel, "sequence": message.sequence, "log_time": message.log_time,
                          "publish_time": message.publish_time, "size": len(message.data), "crc": zlib.crc32(message.data)})


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: read_mcap.py FILE")
    try:
        with open(sys.argv[1], "rb") as stream:
            mcap = Mcap(stream.read())
    except (McapError, OSError, UnicodeDecodeError) as error:
        sys.exit(f"{sys.argv[1]}: {error}")
    for line in lines(mcap):
        print(line)


if __name__ == "__main__":
    main()
