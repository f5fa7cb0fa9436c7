#!/usr/bin/env bash
# validate_gltf.sh FILE...: runs the Khronos glTF validator, which scripts/test installs into build/npm. Exit status:
# 0 no errors, 1 errors (printed), 77 skipped, since node or the validator is not there. LAMBENT_NPM overrides the place.
set -euo pipefail
npm=${LAMBENT_NPM:-$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/build/npm}
if ! command -v node >/dev/null || [[ ! -d $npm/node_modules/gltf-validator ]]; then
  echo "skipped: the glTF validator is not in $npm; scripts/test installs it where npm is present"
  exit 77
fi
NODE_PATH=$npm/node_modules exec node - "$@" <<'JS'
const validator = require('gltf-validator');
const fs = require('fs');
let failed = false;
(async () => {
  for (const file of process.argv.slice(2)) {
    const {issues} = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)));
    console.log(`${file}: ${issues.numErrors} errors, ${issues.numWarnings} warnings`);
    for (const issue of issues.messages.filter(m => m.severity <= 1))
      console.log(`  ${issue.code} at ${issue.pointer}: ${issue.message}`);
    failed = failed || issues.numErrors > 0;
  }
  process.exit(failed ? 1 : 0);
})().catch(error => { console.log(error.message || error); process.exit(1); });
JS
