#!/usr/bin/env bash
# Sets up, builds with sanitizers and warnings as errors, and runs every test.
set -euo pipefail
cd "$(dirname "$0")"

tools/setup.sh
export BRACE_VALIDATION=1
cmake --workflow --preset check
