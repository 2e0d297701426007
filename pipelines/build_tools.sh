#!/bin/sh
# Installs missing packages and builds the tools into build/release/bin, and the targets that are named: build_tools.sh [TARGET ...]
set -eu
cd -- "$(dirname -- "$0")/.."
sh pipelines/install_packages.sh
[ -f build/release/build.ninja ] || cmake --preset release
exec cmake --build build/release --target rt-import rt-grid rt-trace rt-compare "$@"
