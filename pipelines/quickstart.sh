#!/bin/sh
# Installs missing packages, builds the tools and runs the quickstart pipeline; prints a table. Works from any folder.
set -eu
cd -- "$(dirname -- "$0")/.."
tools=build/release
work=build/quickstart

sh pipelines/install_packages.sh
[ -f $tools/build.ninja ] || cmake --preset release
cmake --build $tools --target rt-import rt-grid rt-trace rt-compare
[ -f $work/build.ninja ] || cmake -G Ninja -S pipelines/quickstart -B $work -D RT_TOOLS_DIR="$PWD/$tools/bin"
cmake --build $work
ctest --test-dir $work --output-on-failure
python3 pipelines/quickstart/print_table.py $work
