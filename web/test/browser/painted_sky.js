// Paints lights of lambent-demo as an equirectangular map.
import { Vector3 } from 'three';

const DEGREE = Math.PI / 180;

export const toward = (azimuth, elevation) => new Vector3(
  Math.sin(azimuth * DEGREE) * Math.cos(elevation * DEGREE), Math.sin(elevation * DEGREE),
  Math.cos(azimuth * DEGREE) * Math.cos(elevation * DEGREE));

/** Returns RGBA from the lowest row on; words are constant:R,G,B and sun:AZ,EL,ANGLE,R,G,B. */
export function paintSky(words) {
  const width = 1024, height = 512, data = new Float32Array(4 * width * height), direction = new Vector3();
  const suns = words.map((word) => [word.split(':')[0], word.split(':')[1].split(',').map(Number)]);
  for (let i = 0; i < width * height; ++i) {
    const phi = (((i % width) + 0.5) / width - 0.5) * 2 * Math.PI;
    const theta = Math.PI * (1 - (Math.floor(i / width) + 0.5) / height);
    direction.set(Math.sin(theta) * Math.cos(phi), Math.cos(theta), Math.sin(theta) * Math.sin(phi));
    for (const [kind, n] of suns) {
      if (kind === 'sun' && direction.dot(toward(n[0], n[1])) < Math.cos(n[2] * DEGREE)) continue;
      const rgb = kind === 'sun' ? n.slice(3) : n;
      for (let c = 0; c < 3; ++c) data[4 * i + c] += rgb[c] ?? rgb[0];
    }
  }
  return { data, width, height };
}
