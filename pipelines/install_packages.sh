#!/bin/sh
# Installs the packages of packages.txt that are missing. With nothing missing it asks the network nothing.
set -eu
list=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)/packages.txt

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "install_packages.sh: this system has no apt; packages are known for Debian 12 only." >&2
    echo "Install what $list names, then build with: cmake --preset release && cmake --build --preset release" >&2
    exit 1
fi

wanted=$(sed 's/#.*//' "$list")
# dpkg-query fails when it does not know one of them: that one is missing, the others are still listed.
# shellcheck disable=SC2086
installed=$(dpkg-query -W -f '${db:Status-Status}:${Package}\n' $wanted 2>/dev/null || :)
missing=
for package in $wanted; do
    case "
$installed
" in
    *"
installed:$package
"*) ;;
    *) missing="$missing $package" ;;
    esac
done
[ -n "$missing" ] || exit 0

if [ "$(id -u)" -eq 0 ]; then
    as_root=
elif command -v sudo >/dev/null; then
    as_root=sudo
else
    echo "install_packages.sh: missing$missing; run as root, or install sudo" >&2
    exit 1
fi
echo "Installing$missing"
# The lists may be absent (fresh containers) or name versions that the mirror no longer has.
$as_root apt-get update
# shellcheck disable=SC2086
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $missing
