#!/usr/bin/env python3
"""Makes the manual page and the bash completion of a program from its --help.

    make_manual.py --program build/bin/site_node --command atrium-site --page atrium-site.1 --completion atrium-site.bash
"""

import argparse
import os
import re
import subprocess
import sys

sys.dont_write_bytecode = True  # the source tree stays as it is
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import help_text
import roff
import bash

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

def run(program, *arguments):
    done = subprocess.run([program, *arguments], stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{program} {' '.join(arguments)}: exit code {done.returncode}: {done.stderr.strip()}")
    # what lies in the source tree now is elsewhere when it is installed
    return done.stdout.replace(os.path.join(ROOT, "deploy"), "/usr/share/atrium")


def write(path, text):
    os.makedirs(os.path.dirname(os.path.abspath(path)), exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--command", required=True, help="name under which it is installed")
    parser.add_argument("--page", required=True)
    parser.add_argument("--completion")
    given = parser.parse_args()
    version = re.search(r"\d[\w.~+-]*", run(given.program, "--version"))
    if not version:
        sys.exit(f"{given.program} --version names no version")
    whole = help_text.parse(run(given.program, "--help"))
    parts = {name: help_text.parse(run(given.program, name, "--help")) for name in whole.subcommands()}
    # bin/atrium-site is a link to the program
    names = roff.Names(program=os.path.basename(os.path.realpath(given.program)), command=given.command, version=version.group())
    write(given.page, roff.page(names, whole, parts))
    if given.completion:
        write(given.completion, bash.completion(given.command, whole, parts))


if __name__ == "__main__":
    main()
