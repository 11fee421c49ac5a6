#!/bin/sh
# The tests of the loops with a library that watches its memory and its arithmetic: gcc's address and
# undefined-behaviour sanitizers, in a copy of the checkout.
#
#   scripts/sanitize.sh PYTHON [OPTION OF PYTEST]...
set -eu
cd "$(dirname "$0")/.."
python=$(pwd)/$1
shift
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT INT TERM
for part in engine addin benchmarks tests templates scripts docs pyproject.toml hatch_build.py README.md; do
    cp -r "$part" "$place/"
done
rm -f "$place"/engine/stepping/kernels/_loops*
cd "$place"
CC="gcc -g -O1 -fsanitize=address,undefined -fno-sanitize-recover=undefined" "$python" hatch_build.py
# libasan has to be there before Python; what Python itself keeps at its end is no leak of ours
LD_PRELOAD="$(gcc -print-file-name=libasan.so) $(gcc -print-file-name=libubsan.so)" \
    ASAN_OPTIONS=detect_leaks=0 PYTHONPATH=$place TORSIONBOOK_RUN_SLOW=0 \
    "$python" -m pytest -q -p no:cacheprovider "$@" tests/numerics tests/engine/start tests/engine/backlash tests/validation
