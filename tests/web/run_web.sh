#!/usr/bin/env bash
# run_web.sh PROGRAMS ASSETS: bakes two small scenes, and runs the tests of web/ with it in Node.js and in Chromium.
# Exit status: 0 passed, 77 skipped, since Node.js, Chromium or web/node_modules is not there; LAMBENT_REQUIRE=web makes
# that a failure. Nothing is fetched from the network.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
programs=$(cd "$1" && pwd) assets=$(cd "$2" && pwd) web=$here/../../web

lacks() {
  echo "skipped: $1"
  [[ ,${LAMBENT_REQUIRE:-}, != *,web,* ]] || exit 1
  exit 77
}
command -v node >/dev/null || lacks "Node.js is not here (Debian: apt-get install nodejs npm)"
chromium=$(command -v chromium) || lacks "Chromium is not here (Debian: apt-get install chromium)"
[[ -d $web/node_modules/puppeteer-core ]] || lacks "web/node_modules is not here (cd web && npm ci)"

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$programs/lambent" bake "$assets/hello.glb" -o "$folder/hello.lmb.glb" --quality draft --cache off >/dev/null
node "$web/test/mapped_scene.js" "$folder/mapped.gltf"
"$programs/lambent" bake "$folder/mapped.gltf" -o "$folder/mapped.lmb.glb" --quality draft --rays 128 --cache off >/dev/null
"$programs/lambent" export "$folder/hello.lmb.glb" -o "$folder/arrays" \
  --light constant:1,1,1 --light sun:30,40,20,5 --order 5 >/dev/null
export LAMBENT_BIN=$programs LAMBENT_TEST_BUNDLE=$folder/hello.lmb.glb
export LAMBENT_TEST_BUNDLES=$folder/hello.lmb.glb,$folder/mapped.lmb.glb
export LAMBENT_TEST_ARRAYS=$folder/arrays LAMBENT_TEST_WORK=$folder/work LAMBENT_TEST_MAP=$assets/sky.hdr
# The site, with coarse bakes: its pictures are to be live here, not right.
node "$web/site/make.js" --programs "$programs" --assets "$assets" --output "$folder/site" --scenes hello,gallery \
  --bake='--quality draft --rays 128 --bounces 1 --refine off --cache off'
export LAMBENT_TEST_SITE=$folder/site CHROMIUM=$chromium
cd "$web" && node --test --test-concurrency=1 test/*.test.js test/browser/*.test.js
