// A static file server for tests, which answers ranges as file servers on the web do.
import { createServer } from 'node:http';
import { createReadStream, statSync } from 'node:fs';
import { extname, normalize, join } from 'node:path';

const TYPES = {
  '.html': 'text/html', '.css': 'text/css', '.js': 'text/javascript', '.mjs': 'text/javascript',
  '.wasm': 'application/wasm',
};

/** Serves folders by prefix, as {'/web/': '/path'}, and returns the server and its address. */
export async function serve(folders) {
  const requests = [];
  const server = createServer((request, response) => {
    const path = decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
    const prefix = Object.keys(folders).find((p) => path.startsWith(p));
    const file = prefix && join(folders[prefix], normalize('/' + path.slice(prefix.length)));
    let size;
    try {
      if (!statSync(file).isFile()) throw new Error('no file');
      size = statSync(file).size;
    } catch {
      response.writeHead(404).end();
      return;
    }
    const type = TYPES[extname(file)] ?? 'application/octet-stream';
    const range = /^bytes=(\d+)-(\d*)$/.exec(request.headers.range ?? '');
    requests.push({ path, range: request.headers.range });
    if (range) {
      const first = Number(range[1]), last = Math.min(range[2] ? Number(range[2]) : size - 1, size - 1);
      response.writeHead(206, {
        'content-type': type, 'content-length': last - first + 1, 'content-range': `bytes ${first}-${last}/${size}`,
      });
      createReadStream(file, { start: first, end: last }).pipe(response);
    } else {
      response.writeHead(200, { 'content-type': type, 'content-length': size });
      createReadStream(file).pipe(response);
    }
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  return { server, requests, address: `http://127.0.0.1:${server.address().port}` };
}
