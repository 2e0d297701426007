#!/usr/bin/env python3
"""Makes a tool's manual page and bash completion from what its --help says."""
import argparse
import pathlib
import re
import subprocess

COMMAND = re.compile(r"^(?:Other commands|Another command): (.*)$", re.MULTILINE)


def help_of(tool, command=None):
    arguments = [str(tool)] + ([command] if command else []) + ["--help"]
    text = subprocess.run(arguments, check=True, capture_output=True, text=True).stdout
    return re.sub(r", \d+M\b", "", text)  # the memory of the machine that asks


def parse(text):
    """Help text as (description, usage, sections); a section is a title and its (term, words) entries."""
    description, usage, sections = [], [], []
    entry = None
    for line in text.splitlines():
        if line.startswith("Usage: "):
            usage.append(line[len("Usage: "):])
        elif usage and line and not line.startswith(" "):
            sections.append((line.rstrip(":"), []))
        elif not usage:
            description.append(line)
        elif line.startswith("   ") and entry:
            entry[1] = (entry[1] + " " + line.strip()).strip()
        elif line.strip():
            term, _, words = line.strip().partition("  ")
            entry = [term, words.strip()]
            sections[-1][1].append(entry)
    return " ".join(description).strip(), usage, sections


def commands_of(text):
    found = COMMAND.search(text)
    return re.findall(r"([\w-]+) --help", found.group(1)) if found else []


def escape(text):
    text = text.replace("\\", r"\e").replace("-", r"\-")
    return r"\&" + text if text.startswith((".", "'")) else text


def man_sections(sections, level):
    lines = []
    for title, entries in sections:
        lines.append(f'.{level} "{escape(title.upper() if level == "SH" else title)}"')
        for term, words in entries:
            lines += [".TP", rf"\fB{escape(term)}\fR", escape(words)]
    return lines


def manual(name, version, pages):
    """`pages`: (command or None, parsed help), the tool's own first."""
    description, _, sections = pages[0][1]
    first, _, rest = description.partition(". ")
    lines = [f'.TH {name.upper()} 1 "" "rt-tools {version}" "User Commands"', ".SH NAME",
             rf"{name} \- {escape(first.rstrip('.'))}", ".SH SYNOPSIS"]
    for _, (_, usage, _) in pages:
        for line in usage:
            lines += [rf"\fB{escape(line)}\fR", ".br"]
    lines += [".SH DESCRIPTION", escape(description)] + man_sections(sections, "SH")
    for command, (words, _, parts) in pages[1:]:
        lines += [f'.SH "{name.upper()} {command.upper()}"', escape(words)]
        lines += man_sections([part for part in parts if part[0] != "Exit codes"], "SS")
    return "\n".join(lines) + "\n"


def options_of(sections):
    """Long and short names with the words that their value may be: {name: [words]}; None for no value."""
    options = {}
    for _, entries in sections:
        for term, _ in entries:
            names, _, value = term.partition(" ")
            for name in names.split(","):
                if name.startswith("-"):
                    choices = re.match(r"[a-z][\w-]*(\|[a-z][\w-]*)+", value)
                    options[name] = choices.group(0).split("|") if choices else [] if value else None
    return options


def completion(name, pages):
    function = "_" + name.replace("-", "_")
    lines = [f"# Completes {name}; made from its --help.", f"{function}() {{",
             '    local word="${COMP_WORDS[COMP_CWORD]}" before="${COMP_WORDS[COMP_CWORD-1]}"',
             '    case "${COMP_WORDS[1]}" in']
    commands = [command for command, _ in pages if command]
    for command, (_, _, sections) in pages[1:] + pages[:1]:
        options = options_of(sections)
        lines += [f"    {command or '*'})", '        case "$before" in']
        for option, choices in options.items():
            if choices:
                lines.append(f'        {option}) COMPREPLY=($(compgen -W "{" ".join(choices)}" -- "$word")); return ;;')
        lines += ["        esac", '        if [[ "$word" == -* ]]; then',
                  f'            COMPREPLY=($(compgen -W "{" ".join(options)}" -- "$word")); return', "        fi ;;"]
    lines += ["    esac", '    mapfile -t COMPREPLY < <(compgen -f -- "$word")']  # names may have blanks
    if commands:
        lines.append(f'    [[ $COMP_CWORD == 1 ]] && COMPREPLY+=($(compgen -W "{" ".join(commands)}" -- "$word"))')
    return "\n".join(lines + ["}", f"complete -o filenames -F {function} {name}"]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tool", type=pathlib.Path)
    parser.add_argument("--man", type=pathlib.Path, required=True)
    parser.add_argument("--completion", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    text = help_of(arguments.tool)
    pages = [(None, parse(text))] + [(each, parse(help_of(arguments.tool, each))) for each in commands_of(text)]
    version = subprocess.run([str(arguments.tool), "--version"], check=True, capture_output=True, text=True)
    arguments.man.parent.mkdir(parents=True, exist_ok=True)
    arguments.completion.parent.mkdir(parents=True, exist_ok=True)
    arguments.man.write_text(manual(arguments.tool.name, version.stdout.split()[1], pages))
    arguments.completion.write_text(completion(arguments.tool.name, pages))


if __name__ == "__main__":
    main()
