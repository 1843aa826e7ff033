"""Reads the text of a program's --help."""

import re
from dataclasses import dataclass, field

DESCRIPTION_COLUMN = 30


@dataclass
class Entry:
    """An option, positional argument or subcommand."""

    head: str  # "--bus.world,--world (text; default atrium)"
    text: str

    def names(self):
        return self.head.split(" ")[0].split(",")

    def rest(self):
        """What follows the names: the value, its range and default."""
        return " ".join(self.head.split(" ")[1:])


@dataclass
class Section:
    title: str
    entries: list = field(default_factory=list)


@dataclass
class Help:
    summary: str = ""
    usage: list = field(default_factory=list)
    sections: list = field(default_factory=list)
    notes: list = field(default_factory=list)  # paragraphs after the sections: (title, lines)

    def entries(self, title):
        return [entry for section in self.sections if section.title == title for entry in section.entries]

    def subcommands(self):
        return [entry.names()[0] for entry in self.entries("Subcommands")]

    def options(self):
        """All names of options, long and short."""
        return [name for section in self.sections for entry in section.entries for name in entry.names() if name.startswith("-")]


def _split(line, next_line):
    # A head that is too long for its column has its description on the next line.
    if next_line.startswith(" " * DESCRIPTION_COLUMN):
        return Entry(line.strip(), "")
    head = re.match(r"  (\S.*?)(?:\s{2,}|$)", line)
    if len(line) > DESCRIPTION_COLUMN and line[DESCRIPTION_COLUMN - 1] == " " and len(head.group(1)) > DESCRIPTION_COLUMN - 3:
        return Entry(line[:DESCRIPTION_COLUMN].strip(), line[DESCRIPTION_COLUMN:].strip())
    return Entry(head.group(1), line[head.end():].strip())


def parse(text):
    lines = text.splitlines()
    result = Help()
    at = 0
    summary = []
    while at < len(lines) and not lines[at].startswith("Usage:"):
        summary.append(lines[at].strip())
        at += 1
    result.summary = " ".join(summary).strip()
    while at < len(lines) and lines[at].strip():
        result.usage.append(lines[at].removeprefix("Usage:").strip())
        at += 1
    section = None
    while at < len(lines):
        line = lines[at]
        following = lines[at + 1] if at + 1 < len(lines) else ""
        title = re.fullmatch(r"([A-Z][A-Za-z ,_]*):", line)
        if title and re.match(r"  \S", following) and title.group(1) != "Examples":
            section = Section(title.group(1))
            result.sections.append(section)
        elif section and re.match(r"  \S", line):
            section.entries.append(_split(line, following))
        elif section and line.startswith(" " * DESCRIPTION_COLUMN):
            entry = section.entries[-1]
            entry.text = f"{entry.text} {line.strip()}".strip()
        elif line.strip():
            section = None
            _note(result.notes, line)
        at += 1
    return result


def _note(notes, line):
    title = re.match(r"([A-Z][A-Za-z ]*):\s*(.*)", line)
    if title:
        notes.append((title.group(1), [title.group(2)] if title.group(2) else []))
    elif notes:
        notes[-1][1].append(line)
    else:
        notes.append(("", [line]))
