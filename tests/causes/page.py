#!/usr/bin/env python3
"""Writes docs/causes.md from the table of causes (tests/causes/*.toml); with --check it only compares and fails if the page is old."""

import argparse
import os
import sys
import textwrap

import table

PAGE = os.path.join(table.ROOT, "docs", "causes.md")
HEAD = """# Causes

What went wrong, by the message that a program printed. Search this page for a few words of your message without its names and numbers.
Each row has a part of the message, the program's exit code ([conventions.md](conventions.md#configuration)), the cause and the cure.

`tests/causes/run.py` provokes each of these mistakes and compares message and exit code. This page is generated from
`tests/causes/*.toml`: change a row there and run `tests/causes/page.py`.
"""
WIDTH = 140


def code(text):
    """Text as code in Markdown, even with backquotes in it."""
    fence = "``" if "`" in text else "`"
    space = " " if text.startswith("`") or text.endswith("`") else ""
    return f"{fence}{space}{text}{space}{fence}"


def title(area):
    words = area.replace("_", " ")
    return words[:1].upper() + words[1:]


def wrapped(text):
    return textwrap.wrap(text, WIDTH - 2, initial_indent="  ", subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


def entry(case):
    ends = "" if case.exit is None else f" (exit code {case.exit})" if case.exit else " (goes on)"
    lines = [f"- {' ... '.join(code(text) for text in case.messages)}{ends}  "]
    lines += wrapped(case.cause)
    lines[-1] += "  "  # a line break
    lines += wrapped(f"→ {case.cure}")
    return lines


def page(cases):
    lines = HEAD.splitlines()
    found = {case.program for case in cases}
    for program in [name for name in table.PROGRAMS if name in found] + sorted(found - set(table.PROGRAMS)):
        of_program = [case for case in cases if case.program == program]
        lines += ["", f"## {program}"]
        for area in sorted({case.area for case in of_program}):
            lines += ["", f"### {title(area)}", ""]
            for case in of_program:
                if case.area == area:
                    lines += entry(case)
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="fail if the page is not up to date")
    given = parser.parse_args()
    try:
        text = page(table.read())
    except table.TableError as mistakes:
        sys.exit(str(mistakes))
    old = ""
    if os.path.exists(PAGE):
        with open(PAGE, encoding="utf-8") as stream:
            old = stream.read()
    if given.check:
        if text != old:
            sys.exit("docs/causes.md is not up to date: run tests/causes/page.py")
        return
    with open(PAGE, "w", encoding="utf-8") as stream:
        stream.write(text)


if __name__ == "__main__":
    main()
