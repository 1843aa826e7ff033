"""Writes a completion for bash from the text of --help. It needs no functions of the package bash-completion."""

import re


def _words(rest):
    """The words that an option takes, if --help lists them."""
    choice = re.search(r"\(one of ([^;)]*)", rest) or re.search(r"\{([^{}]*)\}", rest)
    if choice:
        return [word.strip() for word in choice.group(1).split(",")]
    return ["true", "false"] if "(true or false" in rest else []


def _cases(text):
    out = []
    for section in text.sections:
        for entry in section.entries:
            names = [name for name in entry.names() if name.startswith("-")]
            if "--log-level" in names:
                words = ["debug", "info", "warn", "error"]
            elif "--network" in names:
                words = ["loopback", "lan", "wifi", "wan"]
            else:
                words = _words(entry.rest())
            if names and words:
                out.append(f"    {'|'.join(names)}) values=\"{' '.join(words)}\" ;;")
    return out


def completion(command, whole, parts):
    function = "_" + command.replace("-", "_")
    out = [f"# Completion of {command}, made from its --help by deploy/packages/make_manual.py.",
           f"{function}() {{",
           '    local cur="${COMP_WORDS[COMP_CWORD]}" prev="${COMP_WORDS[COMP_CWORD - 1]}" options values=""']
    if parts:
        out += ['    case "${COMP_WORDS[1]}" in']
        for name, part in parts.items():
            out += [f"    {name})", f"        options=\"{' '.join(part.options())}\""]
            cases = _cases(part)
            if cases:
                out += ['        case "$prev" in', *["    " + case for case in cases], "        esac"]
            out += ["        ;;"]
        out += [f"    *) options=\"{' '.join(whole.options() + list(parts))}\" ;;", "    esac",
                "    # the name of the subcommand",
                '    if [ "$COMP_CWORD" -eq 1 ]; then',
                f"        mapfile -t COMPREPLY < <(compgen -W \"{' '.join(whole.options() + list(parts))}\" -- \"$cur\")",
                "        return", "    fi"]
    else:
        out += [f"    options=\"{' '.join(whole.options())}\""]
        cases = _cases(whole)
        if cases:
            out += ['    case "$prev" in', *cases, "    esac"]
    out += ['    if [ -n "$values" ] && [ "${cur:0:1}" != "-" ]; then',
            '        mapfile -t COMPREPLY < <(compgen -W "$values" -- "$cur")',
            '    elif [ "${cur:0:1}" = "-" ]; then',
            '        mapfile -t COMPREPLY < <(compgen -W "$options" -- "$cur")',
            "    fi  # else names of files",
            "}",
            f"complete -o default -F {function} {command}"]
    return "\n".join(out) + "\n"
