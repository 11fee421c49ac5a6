#!/bin/sh
# Make .venv in the checkout and install the locked packages and the checkout itself into it.
#
#   scripts/make_venv.sh REQUIREMENTS_FILE
#
# Needs a Python 3.11 to 3.14 with its venv module, and nothing else. PYTHON=... names one. Tests run with 3.11 to
# 3.13, which are taken first.
set -eu
cd "$(dirname "$0")/.."
requirements=$1
venv=.venv

sorry() {
    printf '\n%s\n\n' "$*" >&2
    exit 1
}

supported() {
    "$1" -c 'import sys; sys.exit(not ((3, 11) <= sys.version_info[:2] <= (3, 14)))' \
        >/dev/null 2>&1
}

has_venv() {
    "$1" -c 'import venv, ensurepip' >/dev/null 2>&1
}

version_of() {
    "$1" -c 'import sys; sys.stdout.write("%d.%d" % tuple(sys.version_info[:2]))' 2>/dev/null
}

# The first supported Python that can make an environment; `seen` and `bare` tell why there is none.
find_python() {
    seen=""
    bare=""
    if [ -n "${PYTHON:-}" ]; then
        candidates=$PYTHON
    else
        candidates="python3.13 python3.12 python3.11 python3 python python3.14"
    fi
    for candidate in $candidates; do
        if supported "$candidate"; then
            if has_venv "$candidate"; then
                return 0
            fi
            bare="${bare:-$candidate}"
        else
            version=$(version_of "$candidate" || true)
            seen="$seen${version:+ $candidate is $version;}"
        fi
    done
    if [ -n "$bare" ]; then
        version=$(version_of "$bare")
        sorry "Python $version ($bare) is here, but its venv module is not. On Debian and Ubuntu it" \
            "is a package of its own: apt-get install python$version-venv. Then run make again."
    fi
    sorry "torsionbook needs Python 3.11 to 3.14 and found none on the PATH" \
        "(tried: $candidates;${seen:- none of them runs}). Install one, or name it:" \
        "make PYTHON=/path/to/python3.12 ..."
}

has_compiler() {
    [ -n "${CC:-}" ] || command -v cc >/dev/null || command -v clang >/dev/null ||
        command -v gcc >/dev/null
}

# An environment is kept when its Python still runs, is supported and was made for this checkout.
usable() {
    [ -x "$venv/bin/python" ] && supported "$venv/bin/python" &&
        "$venv/bin/python" -c 'import pip' >/dev/null 2>&1 &&
        { [ ! -e "$venv/.checkout" ] || [ "$(cat "$venv/.checkout")" = "$(pwd -P)" ]; }
}

if ! usable; then
    find_python
    echo "Making $venv with $candidate ($(version_of "$candidate"))."
    rm -rf "$venv"
    "$candidate" -m venv "$venv" ||
        sorry "$candidate could not make an environment in $venv; what it said stands above."
fi

echo "Installing the packages locked in $requirements."
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-input \
    --require-hashes -r "$requirements" ||
    sorry "The packages of $requirements could not be installed; what pip said stands above." \
        "The first run needs the network; a download that broke off is worth a second try."
# The loops are compiled here: with the compiler of the machine, else with one from the package index.
if ! has_compiler; then
    echo "No C compiler is here: installing the one locked in requirements/build.txt."
    "$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-input \
        --require-hashes -r requirements/build.txt ||
        sorry "The C compiler of requirements/build.txt could not be installed; what pip said" \
            "stands above. Any other does: on Debian and Ubuntu apt-get install gcc."
fi
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-input \
    --no-deps --no-build-isolation --editable . ||
    sorry "The checkout could not be installed into $venv; what pip said stands above."
pwd -P >"$venv/.checkout"
