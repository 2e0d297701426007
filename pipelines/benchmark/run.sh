#!/bin/sh
# Builds what is missing and measures, or with `error` time against error; results in OUT, or build/benchmark(-error):
#     run.sh [error] [OUT] [-D VARIABLE=VALUE ...]
# With RT_TOOLS_DIR, a folder of built programs, nothing is installed or built. Variables: CMakeLists.txt
set -eu
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
repository=${here%/*/*}
out=$repository/build/benchmark
errors=OFF
if [ "${1-}" = error ]; then
    errors=ON
    out=$out-error
    shift
fi
case ${1--} in
-*) ;;
*) out=$1; shift ;;
esac

[ -n "${RT_TOOLS_DIR-}" ] || sh "$repository/pipelines/build_tools.sh" rt_make_rays rt_check_hits rt_measure_hits rt_box_filter
mkdir -p -- "$out"
# Files of earlier runs will be removed there. Meshes may wait for the first one.
if ! grep -qs '^CMAKE_PROJECT_NAME:STATIC=rt-benchmark$' "$out/CMakeCache.txt" && ls -A -- "$out" | grep -qv '\.rtmesh$'; then
    echo "run.sh: $out has files that are none of a benchmark; name a new folder" >&2
    exit 1
fi
if grep -s RT_ERRORS: "$out/CMakeCache.txt" | grep -qv "=$errors"; then
    echo "run.sh: $out has results of the other benchmark; name another folder" >&2
    exit 1
fi
cmake --fresh -G Ninja -S "$here" -B "$out" -D RT_TOOLS_DIR="${RT_TOOLS_DIR:-$repository/build/release/bin}" \
    -D RT_ERRORS=$errors "$@"

cd -- "$out"
# One step at a time, since they are measured; the others go on where one fails: collect.py lists what did. What is large
# goes away with each scene, and what was measured before is measured again.
remove_large() {
    rm -f "$1"/*.rays "$1"/*.hits "$1"-*.hits "$1"-*.rtatlas "$1"-*.exr
}
while read -r scene; do
    rm -f "$scene"/rays.json "$scene"-*.json "$scene"-*.d "$scene"-*.png
    remove_large "$scene"
    {
        cmake --build . --target "$scene-all" -j 1 -- -k 0 || :
        [ $errors = ON ] || ctest -L "^$scene\$" --output-on-failure || :
    } </dev/null 2>&1 | tee "$scene.log"
    remove_large "$scene"
done < scenes.txt
exec python3 -B "$here/collect.py" .
