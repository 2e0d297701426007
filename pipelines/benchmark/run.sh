#!/bin/sh
# Builds what is missing and runs the benchmark: run.sh [OUT [options of run.py]]; OUT is build/benchmark if not given.
set -eu
repository=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
tools=$repository/build/release
out=$repository/build/benchmark
if [ $# -gt 0 ]; then
    out=$1
    shift
fi

sh "$repository/pipelines/install_packages.sh"
[ -f "$tools/build.ninja" ] || (cd -- "$repository" && cmake --preset release)
cmake --build "$tools" --target rt-import rt-grid rt-trace rt_make_rays rt_check_hits
exec python3 -B "$repository/pipelines/benchmark/run.py" --tools "$tools/bin" --out "$out" "$@"
