// Loads a bundle by HTTP ranges: meshes and codebooks first, then weight planes as they come, each of which makes
// light more exact. A bundle's views lie in the order in which they are wanted (docs/format.md, section 1).
import { LambentPlugin } from './plugin.js';
import { EXTENSION } from './bundle.js';

const HEAD_BYTES = 65536, CHUNK_BYTES = 262144;

async function fetchRange(url, first, end, signal) {
  const response = await fetch(url, { headers: { range: `bytes=${first}-${end - 1}` }, signal });
  if (!response.ok) throw new Error(`${url}: the server answers ${response.status}`);
  return { bytes: new Uint8Array(await response.arrayBuffer()), whole: response.status === 200 };
}

// Parses with a plugin of our own, which takes the place of one that is registered already.
function parse(loader, buffer, path, options) {
  const register = (parser) => new LambentPlugin(parser, options);
  loader.register(register);
  const parsed = loader.parseAsync(buffer, path);
  loader.unregister(register);
  return parsed;
}

/**
 * Returns the glTF as soon as it can be shown. `gltf.userData.planesLoaded` is a promise of the rest; `onPlane(done,
 * all)` is called as planes arrive. Servers that know no ranges send the whole file at once.
 */
export async function loadProgressively(loader, url, { onPlane = () => {}, signal } = {}) {
  const path = new URL('.', new URL(url, globalThis.location?.href)).href;
  let { bytes: head, whole } = await fetchRange(url, 0, HEAD_BYTES, signal);
  const view = new DataView(head.buffer), fileBytes = view.getUint32(8, true), jsonBytes = view.getUint32(12, true);
  if (view.getUint32(0, true) !== 0x46546c67) throw new Error(`${url} is no binary glTF`);
  const binary = 28 + jsonBytes;
  if (!whole && head.length < binary) ({ bytes: head, whole } = await fetchRange(url, 0, binary, signal));
  const json = JSON.parse(new TextDecoder().decode(head.subarray(20, 20 + jsonBytes)));
  const extension = json.extensions?.[EXTENSION];
  if (whole || !extension) {
    const file = whole ? head.buffer : (await fetchRange(url, 0, fileBytes, signal)).bytes.buffer;
    const gltf = await parse(loader, file, path);
    gltf.userData.planesLoaded = Promise.resolve();
    return gltf;
  }

  // Planes lie together; what comes before and after them (keyframes of animations) is fetched first.
  const planes = extension.payloads.filter((p) => p.type === 'weightPlane').map((p) => json.bufferViews[p.bufferView]);
  const begin = binary + Math.min(...planes.map((v) => v.byteOffset), fileBytes - binary);
  const end = binary + Math.max(...planes.map((v) => v.byteOffset + v.byteLength), begin - binary);
  const file = new Uint8Array(fileBytes);
  file.set(head.subarray(0, fileBytes));
  const fetchInto = async (first, last) => {
    if (first < last) file.set((await fetchRange(url, first, last, signal)).bytes, first);
  };
  await Promise.all([fetchInto(Math.min(head.length, begin), begin), fetchInto(end, fileBytes)]);
  const gltf = await parse(loader, file.buffer, path, { planes: false });
  const scene = gltf.userData.lambent;
  gltf.userData.planesLoaded = scene ? loadPlanes(scene, fetchInto, file, binary, onPlane) : Promise.resolve();
  return gltf;
}

async function loadPlanes(scene, fetchInto, file, binary, onPlane) {
  const { bundle } = scene, entries = scene.planes();
  const placeOf = ({ plane }) => bundle.json.bufferViews[bundle.extension.payloads[plane.payload].bufferView];
  bundle.viewBytes = async (index) => {
    const { byteOffset, byteLength } = bundle.json.bufferViews[index];
    return file.subarray(binary + byteOffset, binary + byteOffset + byteLength);
  };
  for (let next = 0; next < entries.length; ) {
    const first = placeOf(entries[next]).byteOffset;
    let last = next, end = first;
    for (; last < entries.length && end - first < CHUNK_BYTES; ++last) {
      const { byteOffset, byteLength } = placeOf(entries[last]);
      if (byteOffset < end) break; // the file has another order
      end = byteOffset + byteLength;
    }
    last = Math.max(last, next + 1);
    await fetchInto(binary + first, binary + end);
    for (; next < last; ++next) {
      if (scene.disposed) return;
      scene.addPlane(entries[next], await bundle.plane(entries[next].plane));
    }
    onPlane(next, entries.length);
  }
}
