#!/bin/sh
# Install the built wheel into a new environment outside the checkout and use it there.
#
#   scripts/smoke_wheel.sh PYTHON WHEEL
set -eu
python=$1
wheel=$(cd "$(dirname "$2")" && pwd)/$(basename "$2")
checkout=$(cd "$(dirname "$0")/.." && pwd)
case $python in
/*) ;;
*/*) python=$(pwd)/$python ;;
esac

place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT INT TERM
cd "$place"
unset PYTHONPATH || true

"$python" -m venv env
env/bin/python -m pip install --quiet --disable-pip-version-check --no-input \
    --require-hashes -r "$checkout/requirements/run.txt"
env/bin/python -m pip install --quiet --disable-pip-version-check --no-input \
    --no-deps --no-index "$wheel"

env/bin/python -c '
import pathlib, sys, addin, engine, torsionbook
for package in (addin, engine, torsionbook):
    home = pathlib.Path(list(package.__path__)[0])
    assert home.is_relative_to(pathlib.Path(sys.prefix).resolve()), f"{home} is not the installed one"
'
env/bin/torsionbook version
env/bin/torsionbook new train.xlsx --example proposed
env/bin/torsionbook new blank_si.xlsx --units si
env/bin/torsionbook recalc train.xlsx --out out --json out/train.json
for file in train.xlsx blank_si.xlsx out/train.xlsx out/train.json; do
    [ -s "$file" ] || { echo "The installed wheel made no $file." >&2; exit 1; }
done
echo "The wheel works outside the checkout."
