"""Fails on an #include that points the wrong way.

check_includes.py ROOT         checks the sources below ROOT
check_includes.py --self-test  checks that planted violations are found

tools/X -> formats -> common, never backwards; one tool never includes another; shaders include shaders and *.shared.h
only; headers of ours include no third-party header but GLM and nlohmann/json_fwd.hpp. Tests may include everything.
"""
import pathlib
import re
import sys
import tempfile

FOLDERS = ("common", "formats", "shaders", "tools", "tests")
SUFFIXES = (".h", ".cpp", ".glsl")
GENERATED = {"shaders/resources.glsl"}  # rt-trace writes it for each device
INCLUDE = re.compile(r'^\s*#\s*include\s*(?:"([^"]+)"|<([^>]+)>)', re.MULTILINE)


def layer(path):
    """'common', 'formats', 'shaders', 'tests' or 'tools/rt-x'."""
    parts = path.split("/")
    return "/".join(parts[:2]) if parts[0] == "tools" else parts[0]


def is_shared(path):
    return path.endswith(".shared.h")


def project_fault(source, target):
    """Why `source` must not include `target` (both relative to the root), or None."""
    if source.endswith(".glsl"):
        return None if target.endswith(".glsl") or is_shared(target) else "a shader includes shaders and *.shared.h only"
    if is_shared(source):
        return None if is_shared(target) else "a *.shared.h includes *.shared.h only"
    allowed = {"common": {"common"}, "formats": {"formats", "common"}, "shaders": {"shaders"}}
    here = layer(source)
    if here == "tests":
        return None
    reachable = allowed.get(here, {here, "formats", "common", "shaders"})
    return None if layer(target) in reachable else f"{here} must not depend on {layer(target)}"


def library_fault(source, header):
    """Why `source` must not include <header>, or None."""
    if source.endswith(".glsl"):
        return "a shader includes shaders and *.shared.h only"
    if not source.endswith(".h") or layer(source) == "tests":
        return None
    standard = "/" not in header and "." not in header
    if standard or header.startswith("glm/") or header == "nlohmann/json_fwd.hpp":
        return None
    return "third-party headers stay in .cpp files"


def check(root):
    """All faults below `root`, one line each, and the number of includes looked at."""
    faults, count = [], 0
    for file in sorted(f for folder in FOLDERS for f in (root / folder).rglob("*") if f.suffix in SUFFIXES):
        source = file.relative_to(root).as_posix()
        for match in INCLUDE.finditer(file.read_text()):
            count += 1
            target, header = match.groups()
            if header is not None:
                fault = library_fault(source, header)
            elif target not in GENERATED and not (root / target).is_file():
                fault = "paths are written from the repository's root"
            else:
                fault = project_fault(source, target)
            if fault:
                line = file.read_text().count("\n", 0, match.start(1 if target else 2)) + 1
                faults.append(f"{source}:{line}: {match.group(0).strip()}: {fault}")
    return faults, count


GOOD = {
    "common/a.h": "#include <vector>\n#include <glm/vec3.hpp>\n#include <nlohmann/json_fwd.hpp>\n",
    "common/a.cpp": '#include "common/a.h"\n#include <fmt/format.h>\n',
    "formats/b.shared.h": '#include "formats/c.shared.h"\n',
    "formats/c.shared.h": "#include <glm/vec4.hpp>\n",
    "formats/b.h": '#include "common/a.h"\n#include "formats/b.shared.h"\n',
    "shaders/s.glsl": '#include "formats/b.shared.h"\n#include "shaders/t.glsl"\n',
    "shaders/t.glsl": "",
    "tools/rt-x/x.h": '#include "tools/rt-x/y.h"\n#include "formats/b.h"\n',
    "tools/rt-x/y.h": '#include "common/a.h"\n',
    "tools/rt-z/z.h": "",
    "tests/t.cpp": '#include "tools/rt-x/x.h"\n#include "tools/rt-z/z.h"\n',
}
BAD = {
    "common/bad.cpp": '#include "formats/b.h"\n',
    "common/bad2.h": '#include "tools/rt-x/x.h"\n',
    "formats/bad.cpp": '#include "tools/rt-x/x.h"\n',
    "formats/bad.h": '#include "shaders/t.glsl"\n',
    "formats/bad.shared.h": '#include "formats/b.h"\n',
    "formats/bad2.h": "#include <OpenEXR/ImfHeader.h>\n",
    "tools/rt-x/bad.cpp": '# include "tools/rt-z/z.h"\n',
    "tools/rt-x/bad2.cpp": '#include "tests/t.cpp"\n',
    "tools/rt-x/bad3.cpp": '#include "y.h"\n',
    "tools/rt-x/bad.h": "  #include <unistd.h>\n",
    "shaders/bad.glsl": '#include "common/a.h"\n',
    "shaders/bad.h": '#include "common/a.h"\n',
    "shaders/bad2.glsl": "#include <vector>\n",
}


def self_test():
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in {**GOOD, **BAD}.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        found = [fault.split(":")[0] for fault in check(root)[0]]
    return [f"self-test: found {found}"] if found != sorted(BAD, key=pathlib.PurePosixPath) else []


def main():
    if sys.argv[1:] == ["--self-test"]:
        faults = self_test()
    else:
        faults, count = check(pathlib.Path(sys.argv[1]))
        if count == 0:
            faults = [f"no source found in {sys.argv[1]}"]
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
