#!/usr/bin/env bash
# Sets up, builds, and replays a real head trace over a real MRI on a simulated HTC Vive.
set -euo pipefail
cd "$(dirname "$0")"

tools/setup.sh
cmake --preset release -DBRACE_BUILD_TESTS=OFF >build-demo.log 2>&1 || { cat build-demo.log >&2; exit 3; }
echo "demo: building (log: build-demo.log)"
cmake --build --preset release >>build-demo.log 2>&1 || { cat build-demo.log >&2; exit 3; }
rm -f build-demo.log
build/release/bin/brace run examples/demo.toml --out runs/demo "$@"
