"""What a description's "options" may hold: not what plan itself decides, nor what writes files of which plan knows nothing."""

FILES = "plan names the files that a step writes"
ALWAYS = "plan gives it wherever it can be given"
NEVER = "a step would not make its files"
LOG = "plan reads what a tool prints"
CORES, FOR_PNG = "say it as resources.cores", "say it in pngOptions"
OF_ALL = {
    "-o": FILES, "--output": FILES, "--json": FILES, "--depfile": FILES, "--if-changed": ALWAYS, "-j": CORES, "--threads": CORES,
    "-h": NEVER, "--help": NEVER, "--version": NEVER, "-q": LOG, "--quiet": LOG, "--": NEVER,
}  # fmt: skip
DECIDED = {
    "scenes": {"--list-formats": NEVER},
    "atlases": {"--structure": "say it as structure", "--quality": "say it as quality", "--dry-run": NEVER, "--vdb": FILES},
    "renders": {
        "--size": "say it as size", "--camera": "say it as camera", "--camera-path": "say it as cameraPath",
        "--frames": "say it as frames", "--aov": "say it as passes", "--shard": "say it as shards", "--shard-by": "say it as shardBy",
        "--device": "say it in RT_DEVICES when it runs", "--tonemap": FOR_PNG, "--exposure": FOR_PNG, "--reproducible": ALWAYS,
        "--checkpoint": FILES, "--resume": NEVER, "--rays": NEVER, "--any-hit": NEVER, "--ray-order": NEVER, "--list-devices": NEVER,
        "--list-cameras": NEVER,
    },
    "comparisons": {"--html": FILES, "--junit": FILES, "--list": NEVER, "--self-test": NEVER},
}  # fmt: skip
OF_PNG = ("--tonemap", "--exposure")


def faults_of_options(kind, place, item):
    """(JSON path, what is wrong there)."""
    decided = OF_ALL | DECIDED[kind]
    for i, word in enumerate(item.get("options", [])):
        for name in names_of(word):
            if name in decided:
                yield f"{place}.options[{i}]", f"{name} cannot be given here: {decided[name]}"
    for i, word in enumerate(item.get("pngOptions", [])):
        for name in names_of(word):
            if name not in OF_PNG:
                yield f"{place}.pngOptions[{i}]", f"{name} is none of {', '.join(OF_PNG)}"


def names_of(word):
    """The options that a word gives: --size of --size=1x1, -v and -q of -vq, none of -1,0,2."""
    if not isinstance(word, str) or not word.startswith("-"):
        return []
    if word.startswith("--"):
        return [word.partition("=")[0]]
    return [f"-{letter}" for letter in word[1:]] if word[1:2].isalpha() else []


def value_of(options, name):
    """What an option is given, or None."""
    for i, word in enumerate(options):
        if names_of(word) == [name]:
            return word.partition("=")[2] if "=" in word else next(iter(options[i + 1 : i + 2]), "")
    return None
