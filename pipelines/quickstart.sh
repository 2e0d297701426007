#!/bin/sh
# Installs missing packages, builds the tools and runs the quickstart pipeline; prints a table. Works from any folder.
set -eu
cd -- "$(dirname -- "$0")/.."
work=build/quickstart

sh pipelines/build_tools.sh
[ -f $work/build.ninja ] || cmake -G Ninja -S pipelines/quickstart -B $work -D RT_TOOLS_DIR="$PWD/build/release/bin"
cmake --build $work
ctest --test-dir $work --output-on-failure
python3 pipelines/quickstart/print_table.py $work
