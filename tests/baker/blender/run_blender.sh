#!/usr/bin/env bash
# run_blender.sh PROGRAM VERSION SCRIPT.py [--window]: runs a test of the add-on in Blender, without a window or, under Xvfb,
# with one. Caches, settings and bundles lie in a folder that is removed. Exit status: 0 passed, 77 skipped, since Blender
# or Xvfb is not there; LAMBENT_REQUIRE=blender makes that a failure.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
program=$1 version=$2 script=$3 window=${4:-}

lacks() {
  echo "skipped: $1"
  [[ ,${LAMBENT_REQUIRE:-}, != *,blender,* ]] || exit 1
  exit 77
}
command -v blender >/dev/null || lacks "Blender is not here (Debian: apt-get install blender python3-numpy)"
mode=(blender --background)
if [[ $window ]]; then
  command -v xvfb-run >/dev/null || lacks "there is no Xvfb (Debian: apt-get install xvfb xauth)"
  mode=(xvfb-run -a -s "-screen 0 1280x800x24" blender --enable-event-simulate --window-geometry 0 0 1280 800)
fi

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake -D "ZIP=$folder/lambent-blender.zip" -P "$here/../../../cmake/package/blender.cmake"
export HOME=$folder XDG_CACHE_HOME=$folder/cache LAMBENT_CACHE=$folder/cache/lambent BLENDER_USER_SCRIPTS=$folder/scripts
export BLENDER_USER_CONFIG=$folder/config LIBGL_ALWAYS_SOFTWARE=1 PYTHONPATH=$here PYTHONDONTWRITEBYTECODE=1
export LAMBENT_PROGRAM=$program LAMBENT_VERSION=$version LAMBENT_TEST_FOLDER=$folder
mkdir -p "$folder/scripts/addons"
"${mode[@]}" --factory-startup -noaudio --python-use-system-env --python-exit-code 1 --python "$script" 2>&1 |
  tee "$folder/log"
! grep -q '^Traceback\|^  File' "$folder/log"  # Blender goes on after an error in a panel or a timer.
