"""Fails if a source is not formatted as .clang-format says: check_format.py ROOT

Exit code 77 (skipped) without clang-format 14: other versions lay out the same rules differently.
"""
import pathlib
import re
import shutil
import subprocess
import sys

VERSION = "14"
FOLDERS = ("common", "formats", "shaders", "tools", "tests")


def find_clang_format():
    for name in (f"clang-format-{VERSION}", "clang-format"):
        path = shutil.which(name)
        if path:
            text = subprocess.run([path, "--version"], capture_output=True, text=True, check=True).stdout
            if re.search(rf"version {VERSION}\.", text):
                return path
    return None


def main():
    root = pathlib.Path(sys.argv[1])
    tool = find_clang_format()
    if tool is None:
        print(f"skipped: clang-format {VERSION} is not installed")
        return 77
    files = sorted(f for folder in FOLDERS for f in (root / folder).rglob("*") if f.suffix in (".h", ".cpp"))
    result = subprocess.run([tool, "--dry-run", "--Werror", *files], capture_output=True, text=True)
    if result.returncode != 0:
        wrong = sorted({line.split(":")[0] for line in result.stderr.splitlines() if "error:" in line})
        print("Not formatted; run clang-format -i on:", *wrong, sep="\n  ")
    return result.returncode


if __name__ == "__main__":
    sys.exit(main())
