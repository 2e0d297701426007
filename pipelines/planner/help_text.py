"""Help and errors in the form of the tools, of which pipelines/package/document_tool.py makes pages."""
import argparse

from planner.errors import USAGE, PlanError

COLUMN = 34


class Parser(argparse.ArgumentParser):
    """`arguments`: (names, settings of add_argument) of each; `ending`: more sections."""

    def __init__(self, name, about, arguments, ending):
        super().__init__(prog=name, allow_abbrev=False, add_help=False)
        for names, settings in arguments:
            self.add_argument(*names, **settings)
        self.text = help_text(name, about, arguments, ending)

    def format_help(self):
        return self.text

    def error(self, message):
        raise PlanError(USAGE, f"{message}; see {self.prog} --help")


def whole_number(least):
    """What an option takes that is one, `least` or more."""

    def number(word):
        if not word.isdecimal() or int(word) < least:
            raise argparse.ArgumentTypeError(f"'{word}' is no whole number from {least} on")
        return int(word)

    return number


def help_text(name, about, arguments, ending):
    positionals = [(names, settings) for names, settings in arguments if not names[0].startswith("-")]
    options = [(names, settings) for names, settings in arguments if names[0].startswith("-")]
    usage = " ".join(["Usage:", name, "[OPTIONS]", *(settings.get("metavar", names[0]) for names, settings in positionals)])
    parts = [about, usage, section("Positionals", positionals), section("Options", options), ending]
    return "\n".join(parts)


def section(title, arguments):
    lines = [f"\n{title}:"] + [entry(names, settings) for names, settings in arguments]
    return "\n".join(lines)


def entry(names, settings):
    value = f" {settings['metavar']}" if "metavar" in settings else ""
    term = f"  {','.join(names)}{value}" if names[0].startswith("-") else f"  {settings.get('metavar', names[0])} REQUIRED"
    gap = " " * (COLUMN - len(term)) if len(term) <= COLUMN - 2 else "\n" + " " * COLUMN
    return f"{term}{gap}{settings['help']}"
