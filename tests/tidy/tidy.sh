#!/usr/bin/env bash
# Checks the tree's tidiness; prints every fault, exit code 1 if there is one. Usage: tidy.sh [ROOT]
set -uo pipefail
cd "${1:-$(dirname "$0")/../..}" || exit 2

faults=0
fault() {
  echo "$1"
  faults=$((faults + 1))
}

# The tracked files; all files where the tree came without its history (a source archive).
if git rev-parse --is-inside-work-tree >/dev/null 2>&1; then
  files=$(git ls-files --cached)
else
  files=$(find . -type f -not -path './build/*' -printf '%P\n')
fi
files=$(while read -r f; do [ -f "$f" ] && echo "$f"; done <<<"$files")
sources=$(grep -E '\.(cpp|hpp|c|h|comp|glsl|sh|py|cmake|js|html|css)$|CMakeLists\.txt$|\.ci/run$' <<<"$files")
[ -n "$sources" ] || { echo "no sources found in $(pwd)"; exit 2; }

# Long files are two files.
while read -r f; do
  lines=$(wc -l <"$f")
  [ "$lines" -le 500 ] || fault "$f: $lines lines; accepted: 500"
done <<<"$sources"

# Unfinished work goes into an issue. (The words are put together here so that this file does not hold them.)
unfinished="TO""DO|FIX""ME|XX""X:"
while read -r hit; do
  [ -z "$hit" ] || fault "$hit: unfinished work"
done < <(xargs -d '\n' grep -nIE "\\b($unfinished)" <<<"$sources" | cut -c1-120)

# Nobody else has this machine's folders.
home="(/ho""me/[a-z]|/ro""ot/|/wo""rk/|/Us""ers/)"
while read -r hit; do
  [ -z "$hit" ] || fault "$hit: a path of one machine"
done < <(xargs -d '\n' grep -nIE "(^|[^A-Za-z0-9_.}-])$home" <<<"$files" | cut -c1-120)

# Who opens a folder is told what it is for.
while read -r folder; do
  [ -f "$folder/README.md" ] || fault "$folder: has a CMakeLists.txt and no README.md"
done < <(grep -E '^(hmd_sim|runtime/[a-z_]+|stages|plugins|tests/[a-z_]+|tools|bench|base|traces)/CMakeLists\.txt$' <<<"$files" |
  xargs -n1 dirname)

# A source that no CMake file names is never compiled.
cmake_text=$(grep -E 'CMakeLists\.txt$|\.cmake$' <<<"$files" | xargs cat)
while read -r f; do
  grep -qF "$(basename "$f")" <<<"$cmake_text" || fault "$f: in no CMake file"
done < <(grep -E '\.(cpp|c)$' <<<"$sources")

# One layout for all.
if command -v clang-format >/dev/null; then
  while read -r hit; do
    [ -z "$hit" ] || fault "$hit"
  done < <(grep -E '\.(cpp|hpp|c|h)$' <<<"$sources" | xargs clang-format --dry-run -Werror 2>&1 |
    grep -oE '^[^ ]+:[0-9]+:[0-9]+: error: code should be clang-formatted' | cut -d: -f1 | sort -u |
    sed 's/$/: run clang-format -i on it/')
else
  echo "formatting not checked: clang-format is not installed"
fi

[ "$faults" -eq 0 ] || { echo "$faults faults"; exit 1; }
echo "tidy: $(wc -l <<<"$files") files"
