#!/bin/sh
# Measures the thesis' scenes, see README.md:
#     run.sh [OUT] [-D VARIABLE=VALUE ...]
# OUT is build/thesis if not given. Tools are those in $RT_TOOLS_DIR; if that is not set they are built here.
set -eu
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
repository=${here%/*/*}
out=$repository/build/thesis
case ${1--} in
-*) ;;
*) out=$1; shift ;;
esac

[ -n "${RT_TOOLS_DIR-}" ] || sh "$repository/pipelines/build_tools.sh"
cmake -G Ninja -S "$here" -B "$out" -D RT_TOOLS_DIR="${RT_TOOLS_DIR:-$repository/build/release/bin}" "$@"
status=0 # whatever fails, the rest is measured and written
cmake --build "$out" -j 1 -- -k 0 || status=1 # one step at a time: others would slow it down
ctest --test-dir "$out" --output-on-failure --no-tests=error -j "$(nproc)" || status=1
python3 -B "$here/collect.py" "$out"
python3 -B "$here/figures.py" "$out"
exit $status
