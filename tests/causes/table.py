"""Reads and checks the table of causes: tests/causes/*.toml, one file per area. Each row is one mistake of a user, the message that must
name it, and the cure. run.py runs every row, page.py writes docs/causes.md."""

import dataclasses
import os
import re
import tomllib

FOLDER = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(FOLDER))

# in the order of the page; other programs of tools/ follow
PROGRAMS = ("every program", "site_node", "camera_node", "world_server", "viewer", "visual_hull", "demo", "monitor", "simulated_cameras", "atrium", "build")
KEYS = {"id": str, "program": str, "cause": str, "cure": str, "prepare": str, "command": str, "exit": int, "message": (str, list),
        "needs_data": bool, "by_hand": str}


@dataclasses.dataclass(frozen=True)
class Case:
    id: str
    area: str  # name of the file without .toml
    program: str
    cause: str
    cure: str
    messages: tuple[str, ...]
    exit: int | None = None
    prepare: str = ""
    command: str = ""
    needs_data: bool = False
    by_hand: str = ""  # why no test can provoke it


class TableError(Exception):
    """All mistakes of the table, one per line."""


def _is_sentence(text):
    return bool(re.fullmatch(r"\S.*[.!?]", text)) and "\n" not in text


def _is_program(name):
    return name in PROGRAMS or (re.fullmatch(r"[a-z_]+", name) and os.path.isdir(os.path.join(ROOT, "tools", name)))


def _mistakes(row):
    """What is wrong with one row, as texts."""
    for key, value in row.items():
        if key not in KEYS:
            yield f"unknown key '{key}'; known: {', '.join(KEYS)}"
        elif not isinstance(value, KEYS[key]) or (isinstance(value, bool) and KEYS[key] is int):
            yield f"{key}: wrong type"
    for key in ("id", "program", "cause", "cure", "message"):
        if not row.get(key):
            yield f"{key} is missing"
    if isinstance(row.get("id"), str) and not re.fullmatch(r"[a-z][a-z0-9_]*", row["id"]):
        yield "id: must be words of a-z and 0-9, joined by _"
    if isinstance(row.get("program"), str) and not _is_program(row["program"]):
        yield f"program: must be one of {', '.join(PROGRAMS)}, or another folder of tools/"
    for key in ("cause", "cure"):
        text = row.get(key)
        if isinstance(text, str) and text and not _is_sentence(text):
            yield f"{key}: must be sentences in one line that end with a full stop"
        if isinstance(text, str) and len(text) > 300:
            yield f"{key}: longer than 300 characters"
    messages = row.get("message")
    for text in messages if isinstance(messages, list) else [messages]:
        if not isinstance(text, str) or len(text) < 4 or "\n" in text:
            yield "message: each must be one line of at least 4 characters"
    if row.get("by_hand"):
        for key in ("command", "prepare", "needs_data"):
            if key in row:
                yield f"{key} and by_hand exclude each other"
    else:
        if not row.get("command"):
            yield "command (or by_hand) is missing"
        if "exit" not in row:
            yield "exit is missing"
    if isinstance(row.get("exit"), int) and not 0 <= row["exit"] <= 255:
        yield "exit: must be in [0, 255]"


def _case(row, area):
    messages = row["message"] if isinstance(row["message"], list) else [row["message"]]
    rest = {key: row[key] for key in ("id", "program", "cause", "cure", "exit", "prepare", "command", "needs_data", "by_hand") if key in row}
    return Case(area=area, messages=tuple(messages), **rest)


def read_files(files):
    """The cases of these files, in their order. Raises TableError with all mistakes."""
    cases, mistakes, homes = [], [], {}
    for file in files:
        name = os.path.basename(file)
        with open(file, "rb") as stream:
            try:
                table = tomllib.load(stream)
            except tomllib.TOMLDecodeError as wrong:
                mistakes.append(f"{name}: {wrong}")
                continue
        mistakes += [f"{name}: {key}: unknown table; write [[case]]" for key in table if key != "case"]
        for number, row in enumerate(table.get("case", []), 1):
            where = f"{name}: {row.get('id', f'case {number}')}"
            wrong = [f"{where}: {text}" for text in _mistakes(row)]
            if row.get("id") in homes:
                wrong.append(f"{where}: this id is also in {homes[row['id']]}")
            homes[row.get("id")] = name
            mistakes += wrong
            if not wrong:
                cases.append(_case(row, name.removesuffix(".toml")))
    if mistakes:
        raise TableError("\n".join(mistakes))
    return cases


def files():
    return sorted(os.path.join(FOLDER, name) for name in os.listdir(FOLDER) if name.endswith(".toml"))


def read():
    return read_files(files())
