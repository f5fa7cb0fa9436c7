// Reads viewer/files.txt: what the viewer loads, one line a file, with * for a part of a name.
import { readFileSync, readdirSync } from 'node:fs';
import { dirname, join } from 'node:path';

/** Returns paths below the folder `web`. Throws with what to do if a line has no file. */
export function listedFiles(web) {
  const lines = readFileSync(join(web, 'viewer/files.txt'), 'utf8').split('\n');
  return lines.filter((line) => line && !line.startsWith('#')).flatMap((line) => {
    const folder = dirname(line), name = line.slice(folder.length + 1);
    const pattern = new RegExp(`^${name.split('*').map((part) => part.replace(/[.+]/g, '\\$&')).join('.*')}$`);
    let names = [];
    try {
      names = readdirSync(join(web, folder)).filter((each) => pattern.test(each)).sort();
    } catch {} // the folder is missing
    if (names.length === 0) throw new Error(`web/${line} is missing; run npm ci in web/`);
    return names.map((each) => join(folder, each));
  });
}
