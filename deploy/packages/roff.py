"""Writes a manual page from the text of --help."""

import re
from dataclasses import dataclass

LONGEST_CHOICE = 60  # a longer list of values stands in the text, which is wrapped


@dataclass
class Names:
    program: str  # site_node, as the build calls it
    command: str  # atrium-site, as it is installed
    version: str


def escape(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq").replace("^", "\\(ha").replace("~", "\\(ti")
    return "\\&" + text if text.startswith((".", "'")) else text


def _installed(names, line):
    """A line of an example with the names and places of the installation."""
    # `site_control up` is atrium-up
    program = "%s(?: %s)?" % (re.escape(names.program), re.escape(names.command.removeprefix("atrium-")))
    line = re.sub(r"(?<![\w-])(?<!atrium )(?:build/bin/)?(?:%s)\b(?= |$)" % program, names.command, line)
    line = line.replace("build/bin/site_node", "atrium-site")
    return re.sub(r"(?<![\w/])deploy/", "/usr/share/atrium/", line)


def _entries(entries):
    out = []
    for entry in entries:
        head = ", ".join(f"\\fB{escape(name)}\\fR" for name in entry.names())
        rest, text = entry.rest(), entry.text
        choice = re.search(r":\{([^{}]*)\}", rest)
        if choice and len(choice.group(1)) > LONGEST_CHOICE:
            rest = rest.replace(choice.group(), "")
            text += "; one of " + choice.group(1).replace(",", ", ")
        out += [".TP", f"{head} {escape(rest)}".rstrip(), escape(text or " ")]
    return out


def _verbatim(lines):
    return [".PP", ".nf", ".RS 4", *[escape(line.strip()) for line in lines], ".RE", ".fi"]


def _sections(names, text, heading):
    out = []
    for section in text.sections:
        if section.title in ("Positionals", "Options", "Commands"):
            title = "Arguments" if section.title == "Positionals" else section.title
            out += [f"{heading} {title.upper() if heading == '.SH' else title}", *_entries(section.entries)]
        elif section.title != "Subcommands":
            out += [f".SS {section.title}", *_entries(section.entries)]
    return out


def _notes(names, notes):
    out = []
    for title, lines in notes:
        if title == "Examples":
            out += [".SH EXAMPLES", *_verbatim([_installed(names, line) for line in lines])]
        elif title == "Exit codes":
            out += [".SH EXIT STATUS", *[escape(line) for line in lines]]
        elif title:
            out += [f".SH {title.upper()}", *[escape(line.strip()) for line in lines]]
        else:
            out += [".SH NOTES", *[escape(line.strip()) for line in lines]]
    return out


def page(names, whole, parts):
    # "--bus.world,--world" would end the first sentence at the dot
    first = re.split(r"[.:;](?: |$)", whole.summary)[0]
    out = ['.\\" Made from the --help of the program by deploy/packages/make_manual.py.',
           f'.TH {names.command.upper()} 1 "" "Atrium {names.version}" "Atrium"',
           ".ad l", ".SH NAME", f"{escape(names.command)} \\- {escape(first[:1].lower() + first[1:])}",
           ".SH SYNOPSIS"]
    for usage in whole.usage:
        out += [f".B {escape(_installed(names, usage))}", ".br"]
    out += [".SH DESCRIPTION", escape(whole.summary)]
    if names.program != names.command and names.program != "atrium":
        out += [".PP", f"The build calls this program \\fB{escape(names.program)}\\fR, and so do its messages.",
                f"\\fBatrium {escape(names.command.removeprefix('atrium-'))}\\fR runs it, too."]
    out += _sections(names, whole, ".SH")
    if parts:
        out.append(".SH SUBCOMMANDS")
    for name, part in parts.items():
        out += [f".SS {escape(names.command)} {escape(name)}", escape(part.summary), ".PP",
                f".B {escape(_installed(names, part.usage[0]))}"]
        for section in part.sections:
            if section.title not in ("Positionals", "Options"):
                out += [".PP", escape(f"{section.title}:")]
            out += _entries(section.entries)
        for title, lines in part.notes:
            is_example = title == "Examples"
            out += [".PP", escape(f"{title}:") if title else ""]
            out += _verbatim([_installed(names, line) for line in lines]) if is_example else [escape(line.strip()) for line in lines]
    out += _notes(names, whole.notes)
    others = "" if names.command == "atrium" else "\\fBatrium\\fR(1), "
    out += [".SH SEE ALSO", f"{others}the pages in /usr/share/doc/atrium\\-common/docs, and causes.md there for messages with cause and cure"]
    return "\n".join(line for line in out if line) + "\n"
