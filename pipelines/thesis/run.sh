#!/bin/sh
# Builds what is missing and measures:
#     run.sh [OUT [options of measure.py]]
# OUT is build/thesis if not given.
set -eu
repository=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
tools=$repository/build/release
out=$repository/build/thesis
if [ $# -gt 0 ]; then
    out=$1
    shift
fi

sh "$repository/pipelines/install_packages.sh"
[ -f "$tools/build.ninja" ] || (cd -- "$repository" && cmake --preset release)
cmake --build "$tools" --target rt-import rt-grid rt-trace rt-compare
exec python3 -B "$repository/pipelines/thesis/measure.py" --tools "$tools/bin" --out "$out" "$@"
