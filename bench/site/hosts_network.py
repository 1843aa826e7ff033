"""Hosts of a site as network namespaces around a bridge: shared by site_hosts.py and site_faults.py."""

import json
import os
import re
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import machine  # noqa: E402

SITE = os.path.join(machine.ROOT, "deploy", "sites", "hall.toml")
NODES = ["north", "east", "south", "west"]
HOSTS = [*NODES, "hull", "helper", "world", "viewer"]
# Two people 1.2 m apart, each in a region of its own that all cameras watch; a host of its own computes the right one.
REGIONS = """
[[hull.region]]
name = "left"
bounds = { min = [-1.5, -1.5, 0.0], max = [0.0, 1.5, 2.4] }
[[hull.region]]
name = "right"
bounds = { min = [0.0, -1.5, 0.0], max = [1.5, 1.5, 2.4] }
"""
HELPER = """
[[host]]
name = "helper"
regions = ["right"]
"""


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def enter_namespaces():
    """Starts this program again in namespaces of its own; it gets --inside."""
    os.execvp("unshare", ["unshare", "-Urnm", sys.executable, os.path.abspath(sys.argv[0]), *sys.argv[1:], "--inside"])


def site_text():
    with open(SITE, encoding="utf-8") as file:
        return file.read().replace('"../rigs/', f'"{machine.ROOT}/deploy/rigs/')


def write(folder, name, text):
    path = os.path.join(folder, name)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def as_one_process(text):
    """The text of the same site without hosts."""
    text = re.sub(r"(?m)^min_cameras.*$", "", text.split("[[host]]")[0])
    return text.replace("[capture]", "[capture]\naligned = true")


def write_one_process(folder):
    """Writes the same site as one process; returns its file."""
    return write(folder, "one.toml", as_one_process(site_text()))


def write_regions(folder, rate_hz):
    """Writes the site with two people and two regions, on several hosts and as one process; returns both files."""
    text = re.sub(r"(?m)^rate_hz.*$", f"rate_hz = {rate_hz}", site_text()).replace("[simulation]", "[simulation]\npeople = 2")
    return write(folder, "regions.toml", text + HELPER + REGIONS), write(folder, "one_regions.toml", as_one_process(text) + REGIONS)


def render_room(build, cache, site):
    """Renders the pictures of a site of one process into `cache`, if they are not there."""
    command = [f"{build}/bin/site_node", "--config", site, "--simulation.cache", cache, "--site.seconds", "1"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Network:
    """One network namespace per host, around a bridge. Everything vanishes with this process, which has namespaces of its own."""

    def __init__(self):
        run("mount", "-t", "tmpfs", "none", "/run")
        os.makedirs("/run/netns")
        run("ip", "link", "set", "lo", "up")
        run("ip", "link", "add", "hub", "type", "bridge", "mcast_snooping", "0")
        run("ip", "link", "set", "hub", "up")
        for number, host in enumerate(HOSTS, start=1):
            run("ip", "netns", "add", host)
            run("ip", "link", "add", f"to-{host}", "type", "veth", "peer", "name", "eth0", "netns", host)
            self.plug(host)
            inside = ["ip", "netns", "exec", host, "ip"]
            run(*inside, "link", "set", "lo", "up")
            run(*inside, "link", "set", "eth0", "up")
            run(*inside, "addr", "add", f"10.79.0.{number}/24", "dev", "eth0")
            run(*inside, "route", "add", "default", "dev", "eth0")

    def plug(self, host):
        run("ip", "link", "set", f"to-{host}", "master", "hub", "up")

    def unplug(self, host):
        run("ip", "link", "set", f"to-{host}", "down")

    def bytes_of(self, host):
        """(from the host, to the host) since the start."""
        shown = subprocess.run(["ip", "-s", "-j", "link", "show", "dev", f"to-{host}"], check=True, capture_output=True, text=True)
        counters = json.loads(shown.stdout)[0]["stats64"]
        return [counters[way]["bytes"] for way in ("rx", "tx")]

    def command(self, host, command):
        return ["ip", "netns", "exec", host, *command, "--network", "lan", "--interface", "eth0"]

    def start(self, host, command, log):
        return subprocess.Popen(self.command(host, command), stdout=log, stderr=log)


def report_of(network, build, world):
    """The newest report of the monitor, from the model part's host."""
    command = [f"{build}/bin/monitor", "--json", "--once", "--wait", "5", "--bus.world", world]
    done = subprocess.run(network.command("hull", command), capture_output=True, text=True, check=False)
    lines = done.stdout.strip().splitlines()
    return json.loads(lines[-1]) if lines else None


def program(report, kind):
    return next((p for p in report["programs"] if p["kind"] == kind), None)
