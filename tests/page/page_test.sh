#!/bin/bash
# Opens report pages with made-up records in headless Chromium, light and dark, wide and 400 px, and fails on a
# console error, an empty chart, a blocked request or content wider than the window.
#   page_test.sh WRITE_EXAMPLE_REPORT PAGE_FOLDER
# Exit code 77 (skipped) when Chromium is not installed.
set -u
write_example_report=$1
page_folder=$2
here=$(cd "$(dirname "$0")" && pwd)

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome)
if [ -z "$browser" ]; then
  echo "skipped: no chromium in PATH (Debian package chromium)"
  exit 77
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$write_example_report" "$page_folder" "$work" || exit 1

# check PAGE LEAST_CHARTS WIDTH [FLAG]
check() {
  local name page dom problems charts
  name=$(tr -c 'a-z0-9\n' _ <<< "$*")
  page=$work/checked_$name.html
  awk -v head="$here/page_check_head.html" -v tail="$here/page_check_tail.html" '
    function insert(file,   line) { while ((getline line < file) > 0) print line; close(file) }
    /^<\/body>$/ { insert(tail) }
    { print }
    /^<head>$/ { insert(head) }' "$work/$1" > "$page"
  dom=$(timeout 90 "$browser" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync --user-data-dir="$work/profile_$name" \
    --virtual-time-budget=5000 --window-size="$3",900 ${4:+"$4"} --dump-dom "file://$page" 2> "$work/log_$name")
  problems=$(grep -o -m1 'data-problems="[^"]*"' <<< "$dom")
  charts=$(grep -o -m1 'data-charts="[0-9]*"' <<< "$dom" | tr -dc 0-9)
  if [ "$problems" = 'data-problems="none"' ] && [ "${charts:-0}" -ge "$2" ]; then
    echo "ok: $1 at $3 px ${4:-}: $charts charts"
  else
    echo "FAILED: $1 at $3 px ${4:-}: charts ${charts:-none} (at least $2 wanted), ${problems:-the page did not run}"
    [ -z "$problems" ] && tail -5 "$work/log_$name"
    touch "$work/failed"
  fi
}

check single.html 7 1200 &
check single.html 7 400 --force-dark-mode
wait
check comparison.html 7 1200 --force-dark-mode &
check comparison.html 7 400
wait
check long.html 7 1200 &
check one_vsync.html 0 1200
wait
check sweep.html 2 1200 &
check sweep.html 2 400 --force-dark-mode
wait
check many_methods.html 2 1200 --force-dark-mode &
check many_methods.html 2 400
wait

[ ! -e "$work/failed" ]
