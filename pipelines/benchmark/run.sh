#!/bin/sh
# Builds what is missing and runs the benchmark, or that of time against error:
#     run.sh [error] [OUT [options of run.py or error.py]]
# OUT is build/benchmark if not given.
set -eu
repository=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
tools=$repository/build/release
out=$repository/build/benchmark
script=run.py
if [ "${1-}" = error ]; then
    script=error.py
    shift
fi
if [ $# -gt 0 ]; then
    out=$1
    shift
fi

sh "$repository/pipelines/install_packages.sh"
[ -f "$tools/build.ninja" ] || (cd -- "$repository" && cmake --preset release)
cmake --build "$tools" --target rt-import rt-grid rt-trace rt-compare rt_make_rays rt_check_hits rt_measure_hits rt_box_filter
exec python3 -B "$repository/pipelines/benchmark/$script" --tools "$tools/bin" --out "$out" "$@"
