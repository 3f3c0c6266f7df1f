#!/bin/bash
# Installs what the tests need, builds `release`, runs every test.
#
#   tests/run.sh [ARGUMENT...]      the arguments go to ctest, e.g. tests/run.sh -R transport
#
# Tests on the real scenes look for them in $STRATA_SHARED, else in ../shared beside this checkout,
# and are skipped where there are none. What each test did is in build/release/results/, as XML.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

deploy/install-packages.sh build test
deploy/build.sh release -DSTRATA_TESTS=ON -DSTRATA_BENCH=ON
exec ctest --preset release --parallel "$(nproc)" "$@"
