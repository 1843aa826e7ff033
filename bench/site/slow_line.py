"""A line between two network devices that delays what goes from the first to the second: `slow_line.py FIRST SECOND DELAY_MS`.

In place of `tc netem`, which many kernels lack. Prints "ready" once it passes packets on; needs CAP_NET_RAW. Ends with SIGTERM.
"""

import collections
import select
import socket
import sys
import time

ETH_P_ALL = 3
SOL_PACKET = 263
PACKET_VNET_HDR = 15  # keeps checksums that the sender left to its card
LARGEST = 1 << 17


def open_device(name):
    line = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(ETH_P_ALL))
    line.setsockopt(SOL_PACKET, PACKET_VNET_HDR, 1)
    line.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 8 << 20)
    line.bind((name, 0))
    line.setblocking(False)
    return line


def packets_of(line):
    """All that has arrived, without what this program sent."""
    while True:
        try:
            packet, address = line.recvfrom(LARGEST)
        except BlockingIOError:
            return
        if address[2] != socket.PACKET_OUTGOING:
            yield packet


def send(line, packet):
    try:
        line.send(packet)
    except OSError:
        pass  # a full queue loses packets, as a real one does


def main():
    first, second = open_device(sys.argv[1]), open_device(sys.argv[2])
    delay_s = 1e-3 * float(sys.argv[3])
    waiting = collections.deque()  # (due, packet)
    print("ready", flush=True)
    while True:
        patience_s = max(0.0, waiting[0][0] - time.monotonic()) if waiting else None
        readable, _, _ = select.select([first, second], [], [], patience_s)
        if second in readable:
            for packet in packets_of(second):
                send(first, packet)
        if first in readable:
            due = time.monotonic() + delay_s
            waiting.extend((due, packet) for packet in packets_of(first))
        while waiting and waiting[0][0] <= time.monotonic():
            send(second, waiting.popleft()[1])


if __name__ == "__main__":
    main()
