#!/bin/sh
# Rewrite requirements/*.txt from pyproject.toml: exact versions with the hashes of every wheel, one
# version of each package for Python 3.11 to 3.13 on Linux, Windows and macOS, no index address.
# Versions already locked are kept unless the new constraints or "--upgrade" say otherwise.
#
#   scripts/lock.sh PYTHON [--upgrade | --upgrade-package NAME]
set -eu
cd "$(dirname "$0")/.."
python=$1
shift

compile() {
    "$python" -m uv pip compile --quiet --universal --python-version 3.11 \
        --fork-strategy fewest --generate-hashes \
        --custom-compile-command "make lock" "$@"
}

group() { echo "--group pyproject.toml:$1"; }

# shellcheck disable=SC2046  # the two words of group() are two arguments
{
    compile "$@" pyproject.toml $(group build) -o requirements/run.txt
    compile "$@" $(group parquet) -c requirements/run.txt -o requirements/parquet.txt
    compile "$@" $(group excel) -c requirements/run.txt -o requirements/excel.txt
    compile "$@" $(group server) -c requirements/run.txt -o requirements/server.txt
    compile "$@" $(group shared) -o requirements/shared.txt
    compile "$@" $(group mcp) -c requirements/run.txt -c requirements/server.txt -o requirements/mcp.txt
    compile "$@" $(group report) -c requirements/run.txt -o requirements/report.txt
    compile "$@" $(group python) -c requirements/run.txt -c requirements/report.txt -o requirements/python.txt
    compile "$@" $(group cluster) -c requirements/run.txt -o requirements/cluster.txt
    compile "$@" pyproject.toml $(group build) $(group parquet) $(group excel) $(group server) \
        $(group shared) $(group mcp) $(group report) $(group python) $(group cluster) $(group dev) -c requirements/run.txt \
        -c requirements/parquet.txt -c requirements/excel.txt -c requirements/server.txt \
        -c requirements/shared.txt -c requirements/mcp.txt -c requirements/report.txt -c requirements/python.txt \
        -c requirements/cluster.txt -o requirements/dev.txt
    compile "$@" $(group compiler) -o requirements/build.txt
    compile "$@" $(group lock) -o requirements/lock.txt
}
