#!/bin/sh
# Packs the built tools, those of pipelines/benchmark too if they are there, with the shared libraries they need, so that
# they run on a machine without the packages:
#     sh tests/bench/bundle.sh BIN_DIR OUT.tar.gz
# There: unpack, then ./rt-tools/rt-trace ... (needs a C library as new as the one here; libEGL comes from the driver).
set -eu
bin=$1
out=$2
stage=$(mktemp -d)
trap 'rm -rf "$stage"' EXIT
mkdir -p "$stage/rt-tools/bin" "$stage/rt-tools/lib"
for tool in rt-import rt-grid rt-trace rt-compare rt_make_rays rt_check_hits \
    rt_measure_hits rt_box_filter rt_stress_tests; do
    case $tool in rt_*) [ -f "$bin/$tool" ] || continue ;; esac
    cp "$bin/$tool" "$stage/rt-tools/bin/"
    strip "$stage/rt-tools/bin/$tool"
    cat > "$stage/rt-tools/$tool" <<'WRAPPER'
#!/bin/sh
here=$(dirname "$(readlink -f "$0")")
LD_LIBRARY_PATH="$here/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}" exec "$here/bin/$(basename "$0")" "$@"
WRAPPER
    chmod +x "$stage/rt-tools/$tool"
done
# The C library and the loader must be the target's own.
ldd "$stage"/rt-tools/bin/* |
    awk '$2 == "=>" && $3 ~ /^\// { print $3 }' | sort -u |
    grep -vE '/(libc|libm|libdl|librt|libpthread|libresolv|libmvec)\.so' |
    while read -r library; do cp -L "$library" "$stage/rt-tools/lib/"; done
tar -C "$stage" -czf "$out" rt-tools
