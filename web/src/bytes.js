// Takes values off the front of a payload, as runtime/base/payload_bytes.hpp does. Every length is checked before it
// is used, so that a damaged payload ends in an error that names it.

/** Maps 0, 1, 2, 3, ... back to 0, -1, 1, -2, ... */
export const unzigzag = (word) => (word >>> 1) ^ -(word & 1);

export class Front {
  constructor(bytes, subject) {
    this.bytes = bytes;
    this.subject = subject;
    this.at = 0;
  }

  take(count) {
    if (!(count <= this.bytes.length - this.at)) throw new Error(`${this.subject} is damaged: it is too short`);
    this.at += count;
    return this.bytes.subarray(this.at - count, this.at);
  }

  /** Returns a typed array of little-endian values; the copy makes it aligned. */
  values(type, count) {
    return new type(this.take(count * type.BYTES_PER_ELEMENT).slice().buffer);
  }

  /** Returns 16-bit words that are stored as a run of low bytes and a run of high bytes. */
  split(count) {
    const bytes = this.take(2 * count), out = new Uint16Array(count);
    for (let i = 0; i < count; ++i) out[i] = bytes[i] | (bytes[count + i] << 8);
    return out;
  }

  /** Returns zigzag integers that are stored as four runs of bytes, the lowest bytes first. */
  integers(count) {
    const bytes = this.take(4 * count), out = new Int32Array(count);
    for (let i = 0; i < count; ++i)
      out[i] = unzigzag(
        bytes[i] | (bytes[count + i] << 8) | (bytes[2 * count + i] << 16) | (bytes[3 * count + i] << 24),
      );
    return out;
  }

  finish() {
    if (this.at !== this.bytes.length) throw new Error(`${this.subject} is damaged: bytes are left over`);
  }
}
