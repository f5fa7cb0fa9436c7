#!/usr/bin/env bash
# run_web.sh PROGRAMS ASSETS: bakes seven small scenes and Sponza, and runs the tests of web/ with them in Node.js and in
# Chromium. Sponza comes from ../shared/data beside the checkout, or from LAMBENT_SHARED_DATA; without the data it is left
# out.
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
bundles=$folder/hello.lmb.glb
for scene in mapped reflecting moving lamps bulbs volume; do
  node "$web/test/${scene}_scene.js" "$folder/$scene.gltf"
  "$programs/lambent" bake "$folder/$scene.gltf" -o "$folder/$scene.lmb.glb" --quality draft --rays 128 --bounces 1 \
    --volume-grid 12 --cache off >/dev/null
  bundles=$bundles,$folder/$scene.lmb.glb
done
sponza=${LAMBENT_SHARED_DATA:-$here/../../../shared/data}/architecture/dabrovic-sponza/dabrovic-sponza.glb
if [[ -f $sponza ]]; then
  "$programs/lambent" bake "$sponza" -o "$folder/sponza.lmb.glb" --quality draft --rays 128 --bounces 1 --refine off \
    --cache off >/dev/null
  bundles=$bundles,$folder/sponza.lmb.glb
else
  [[ ,${LAMBENT_REQUIRE:-}, != *,data,* ]] || { echo "$sponza is not here"; exit 1; }
  echo "without Sponza: $sponza is not here; set LAMBENT_SHARED_DATA to the folder with architecture/"
fi
"$programs/lambent" export "$folder/hello.lmb.glb" -o "$folder/arrays" \
  --light constant:1,1,1 --light sun:30,40,20,5 --order 5 >/dev/null
export LAMBENT_BIN=$programs LAMBENT_TEST_BUNDLE=$folder/hello.lmb.glb
export LAMBENT_TEST_BUNDLES=$bundles
export LAMBENT_TEST_ARRAYS=$folder/arrays LAMBENT_TEST_WORK=$folder/work LAMBENT_TEST_MAP=$assets/sky.hdr
# The site, with coarse bakes: its pictures are to be live here, not right.
node "$web/site/make.js" --programs "$programs" --assets "$assets" --output "$folder/site" --scenes hello,gallery \
  --bake='--quality draft --rays 128 --bounces 1 --refine off --cache off'
export LAMBENT_TEST_SITE=$folder/site CHROMIUM=$chromium
cd "$web" && node --test --test-concurrency=1 test/*.test.js test/browser/*.test.js
