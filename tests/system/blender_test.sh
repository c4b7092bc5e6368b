#!/usr/bin/env bash
# The Blender add-on's tests inside Blender without a window. Ends with 77, and says so, where Blender is not installed.
#
#   blender_test.sh POSTLENS SOURCE_DIR
set -euo pipefail

postlens=$1 source_dir=$2
if ! command -v blender >/dev/null; then
    echo "skipped: blender is not installed (scripts/install_dependencies.sh --for peers)"
    exit 77
fi
# Debian's Blender takes its Python packages from where the path's first python3 is: that must be Debian's, with numpy.
export PATH=/usr/bin:$PATH PYTHONDONTWRITEBYTECODE=1
unset PYTHONPATH PYTHONHOME
settings=$(mktemp -d)
trap 'rm -rf "$settings"' EXIT
export BLENDER_USER_CONFIG=$settings
log=$settings/log
if ! blender -b --factory-startup -noaudio --python-exit-code 1 -P "$source_dir/blender/tests/addon_test.py" -- "$postlens" \
    >"$log" 2>&1; then
    grep -v '^Fra:\|^Saved\|^ *Time:\|^$' "$log" | tail -60
    exit 1
fi
grep '^Ran ' "$log"
