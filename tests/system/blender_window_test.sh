#!/usr/bin/env bash
# The Blender add-on's tests in Blender's window, on a display of their own. Ends with 77, and says so, where Blender, Xvfb
# or xdotool is not installed.
#
#   blender_window_test.sh POSTLENS SOURCE_DIR [TEST...]
#
# Screenshots go to the folder that the variable SCREENSHOTS names, if it is set.
set -euo pipefail

postlens=$1 source_dir=$2
shift 2
for program in blender xvfb-run Xvfb xdotool; do
    if ! command -v $program >/dev/null; then
        echo "skipped: $program is not installed (scripts/install_dependencies.sh --for peers)"
        exit 77
    fi
done
if [[ -z ${ON_TEST_DISPLAY:-} ]]; then
    ON_TEST_DISPLAY=1 exec xvfb-run -a -s "-screen 0 1280x800x24" "$0" "$postlens" "$source_dir" "$@"
fi
script=$source_dir/blender/tests/window_test.py
tests=("$@")
if ((${#tests[@]} == 0)); then
    mapfile -t tests < <(sed -nE 's/^    def (test_\w+).*/\1/p' "$script")
fi
# Debian's Blender takes its Python packages from where the path's first python3 is: that must be Debian's, with numpy.
export PATH=/usr/bin:$PATH PYTHONDONTWRITEBYTECODE=1
unset PYTHONPATH PYTHONHOME
settings=$(mktemp -d)
trap 'rm -rf "$settings"' EXIT
export BLENDER_USER_CONFIG=$settings TMPDIR=$settings/tmp LIBGL_ALWAYS_SOFTWARE=1
mkdir "$TMPDIR"

# Every test has a Blender of its own: a failure then leaves no window, timer or setting behind for the next.
failures=0
for name in "${tests[@]}"; do
    log=$settings/$name.log
    timeout -k 5 600 blender --factory-startup -noaudio -p 0 0 1280 800 -P "$script" -- "$postlens" "$log" \
        "${SCREENSHOTS:-}" "$name" >"$log" 2>&1 || grep -v '^Fra:\|^Saved\|^ *Time:\|INFO:\|^$' "$log" | tail -30
    # The test that closes Blender cannot report its own result.
    if command=$(sed -nE 's/^command ([0-9]+)$/\1/p' "$log") && [[ -n $command ]]; then
        ! kill -0 "$command" 2>/dev/null && grep -q '^Blender quit' "$log" && ! grep -q '^Traceback' "$log" &&
            echo "$name ... ok" >>"$log"
    fi
    if ! grep "^$name \.\.\. ok" "$log"; then
        echo "$name ... FAIL"
        failures=$((failures + 1))
    fi
done
if compgen -G "$TMPDIR/postlens_*" >/dev/null; then
    echo "files are left: $(ls "$TMPDIR")"
    failures=$((failures + 1))
fi
echo "Ran ${#tests[@]} tests, $failures failed"
((failures == 0))
