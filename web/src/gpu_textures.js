// Textures that hold lists of numbers, which shaders read by texelFetch. They are 2048 wide, as every device with WebGL 2
// allows: entry i lies in column i mod 2048 of row i / 2048.
import {
  DataTexture, FloatType, HalfFloatType, LinearFilter, NearestFilter, RGBAFormat, RGBAIntegerFormat, RGIntegerFormat,
  UnsignedIntType, UnsignedShortType, WebGLRenderTarget,
} from 'three';

export const LIST_WIDTH = 2048;
/** GLSL: the place of an entry. */
export const PLACE_TEXT = 'ivec2 lambentPlace(int i) { return ivec2(i & 2047, i >> 11); }';

/** Returns the rows of a list. */
export const rowsFor = (count) => Math.max(1, Math.ceil(count / LIST_WIDTH));

function listTexture(count, Type, channels, format, type) {
  const rows = rowsFor(count);
  const texture = new DataTexture(new Type(LIST_WIDTH * rows * channels), LIST_WIDTH, rows, format, type);
  texture.magFilter = texture.minFilter = NearestFilter;
  texture.needsUpdate = true;
  return texture;
}

/** Entries of four floats. The array is `texture.image.data`; set needsUpdate after a change. */
export const floatList = (count) => listTexture(count, Float32Array, 4, RGBAFormat, FloatType);
/** Entries of four 16-bit integers. */
export const shortList = (count) => listTexture(count, Uint16Array, 4, RGBAIntegerFormat, UnsignedShortType);
/** Entries of two or four 32-bit integers. */
export const integerList = (count, channels) => listTexture(
  count, Uint32Array, channels, channels === 2 ? RGIntegerFormat : RGBAIntegerFormat, UnsignedIntType);

/** Tells whether a device can write lists of floats. Hardly any with WebGL 2 cannot. */
export const canWriteLists = (renderer) => renderer.extensions.has('EXT_color_buffer_float');

/** A target that a pass writes a list of four floats to. */
export function listTarget(rows) {
  return new WebGLRenderTarget(LIST_WIDTH, rows, {
    type: FloatType, format: RGBAFormat, magFilter: NearestFilter, minFilter: NearestFilter, depthBuffer: false,
  });
}

/** A target whose texture is filtered. */
export function pictureTarget(width, height) {
  return new WebGLRenderTarget(width, height, {
    type: HalfFloatType, format: RGBAFormat, magFilter: LinearFilter, minFilter: LinearFilter, depthBuffer: false,
  });
}
