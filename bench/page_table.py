"""Reads results of benchmarks, and puts tables into pages. Shared by the scripts here."""

import csv
import os
import sys


def read_rows(path):
    """Rows of a CSV file as dictionaries of text, and its lines that begin with # as one."""
    with open(path, encoding="utf-8") as file:
        lines = file.read().splitlines()
    comment = " ".join(line[1:].strip() for line in lines if line.startswith("#"))
    return list(csv.DictReader(line for line in lines if not line.startswith("#"))), comment


def read_numbers(path):
    """Like `read_rows`, with numbers as floats; nothing if the file is missing."""
    if not os.path.exists(path):
        return [], ""
    rows, comment = read_rows(path)
    for row in rows:
        for key, value in row.items():
            try:
                row[key] = float(value)
            except ValueError:
                pass
    return rows, comment


def table(title, header, rows):
    """Prints a table below its title; returns the table."""
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    print(f"\n{title}\n\n" + "\n".join(lines))
    return "\n".join(lines)


def renew(page, name, text):
    """Puts text between <!-- name --> and <!-- /name --> of a page."""
    with open(page, encoding="utf-8") as file:
        content = file.read()
    begin, end = f"<!-- {name} -->", f"<!-- /{name} -->"
    if content.count(begin) != 1 or content.count(end) != 1:
        sys.exit(f"{page}: has no {begin} ... {end}")
    head, rest = content.split(begin)
    with open(page, "w", encoding="utf-8") as file:
        file.write(head + begin + f"\n{text}\n" + end + rest.split(end)[1])


def put_table(page, name, lines, comment):
    """Prints a table and its origin, and puts both into a page like `renew`."""
    text = "\n".join([*lines, "", comment + "."])
    print(text)
    renew(page, name, text)


def between(page, name):
    """The text between <!-- name --> and <!-- /name --> of a page, in the form of `renew`; None if the markers are missing."""
    with open(page, encoding="utf-8") as file:
        content = file.read()
    begin, end = f"<!-- {name} -->\n", f"\n<!-- /{name} -->"
    if content.count(begin) != 1 or content.count(end) != 1:
        return None
    return content.split(begin)[1].split(end)[0]
