#!/bin/sh
# Installs missing packages, builds the release preset and runs all tests. Works from any folder.
set -eu
cd -- "$(dirname -- "$0")/.."
sh pipelines/install_packages.sh
cmake --preset release
cmake --build --preset release
ctest --preset release --output-on-failure --no-tests=error -j2
