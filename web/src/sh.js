// Spherical harmonics: real, orthonormal, without the Condon-Shortley sign, index l(l+1)+m, polar axis +Z
// (docs/conventions.md). An order n means n bands and n² coefficients.

export const MAX_ORDER = 8;

// Clamped-cosine weights A_l / π of bands 0 to 7.
const COSINE_OVER_PI = [1, 2 / 3, 1 / 4, 0, -1 / 24, 0, 1 / 64, 0];

// Factors of the recurrences over l, by m and l; they are Cartesian, so the poles are ordinary points.
const at = (m, l) => MAX_BASIS * m + l;
const MAX_BASIS = 24, FORWARD = new Float64Array(MAX_BASIS ** 2), BACK = new Float64Array(MAX_BASIS ** 2);
const SECTORAL = new Float64Array(MAX_BASIS); // y_mm without (x + iy)^m; √2 is inside for m > 0
for (let m = 0; m < MAX_BASIS; ++m) {
  if (m === 0) SECTORAL[0] = 0.28209479177387814;
  else SECTORAL[m] = SECTORAL[m - 1] * (m === 1 ? Math.sqrt(3) : Math.sqrt((2 * m + 1) / (2 * m)));
  for (let l = m + 1; l < MAX_BASIS; ++l) {
    const k = l - 1;
    FORWARD[at(m, l)] = Math.sqrt((4 * l * l - 1) / (l * l - m * m));
    if (l > m + 1) BACK[at(m, l)] = FORWARD[at(m, l)] * Math.sqrt((k * k - m * m) / (4 * k * k - 1));
  }
}

/** Writes y_i(direction) for the n² functions of an order; the direction has unit length. */
export function evaluateBasis(order, x, y, z, out) {
  let c = 1, s = 0; // real and imaginary part of (x + iy)^m
  for (let m = 0; m < order; ++m) {
    if (m > 0) {
      const next = x * c - y * s;
      s = x * s + y * c;
      c = next;
    }
    let p = SECTORAL[m], before = 0;
    for (let l = m; l < order; ++l) {
      if (l > m) {
        const next = FORWARD[at(m, l)] * z * p - BACK[at(m, l)] * before;
        before = p;
        p = next;
      }
      out[l * (l + 1) + m] = p * c;
      if (m > 0) out[l * (l + 1) - m] = p * s;
    }
  }
  return out;
}

/** Writes the transfer of an open surface, A_l/π y_i(normal), whose product with the light is E/π. */
export function unoccludedTransfer(order, x, y, z, out) {
  evaluateBasis(order, x, y, z, out);
  for (let l = 0; l < order; ++l)
    for (let i = l * l; i < (l + 1) * (l + 1); ++i) out[i] *= COSINE_OVER_PI[l];
  return out;
}

// Builds rows of band l of D(R^-1) from band l-1 by the recurrence of Ivanic and Ruedenberg (1996, with the
// corrections of 1998). `first` is band 1; a band is a list of rows m = -l..l of columns n = -l..l.
function nextBand(l, first, before) {
  const column = (n) => 1 / Math.sqrt(Math.abs(n) === l ? 2 * l * (2 * l - 1) : (l + n) * (l - n));
  const p = (i, a, n) => {
    const [minus, zero, plus] = first[i + 1];
    const row = before[a + l - 1], last = 2 * l - 2;
    if (n === -l) return (plus * row[0] + minus * row[last]) * column(n);
    if (n === l) return (plus * row[last] - minus * row[0]) * column(n);
    return zero * row[n + l - 1] * column(n);
  };
  const band = [];
  for (let m = -l; m <= l; ++m) {
    const a = Math.abs(m), zero = m === 0 ? 1 : 0;
    const u = Math.sqrt((l + m) * (l - m));
    const v = 0.5 * Math.sqrt((1 + zero) * (l + a - 1) * (l + a)) * (1 - 2 * zero);
    const w = -0.5 * Math.sqrt((l - a - 1) * (l - a)) * (1 - zero);
    const row = new Float64Array(2 * l + 1);
    for (let n = -l; n <= l; ++n) {
      let sum = a < l ? u * p(0, m, n) : 0;
      if (m === 0) sum += v * (p(1, 1, n) + p(-1, -1, n));
      else if (a === 1) sum += v * Math.SQRT2 * p(m, 0, n);
      else if (m > 1) sum += v * (p(1, m - 1, n) - p(-1, -m + 1, n));
      else sum += v * (p(1, m + 1, n) + p(-1, -m - 1, n));
      if (m > 0 && m < l - 1) sum += w * (p(1, m + 1, n) + p(-1, -m - 1, n));
      if (m < 0 && m > 1 - l) sum += w * (p(1, m - 1, n) - p(-1, -m + 1, n));
      row[n + l] = sum;
    }
    band.push(row);
  }
  return band;
}

/**
 * Returns the bands of D(R^-1) for rotateCoefficients. `matrix` is the rotation R as nine numbers, column by column, like
 * the elements of three's Matrix3.
 */
export function rotationBands(order, matrix) {
  const axis = [1, 2, 0]; // band 1 has the order y, z, x
  const first = axis.map((a) => axis.map((b) => matrix[3 * a + b])), bands = [[[1]], first];
  for (let l = 2; l < order; ++l) bands.push(nextBand(l, first, bands[l - 1]));
  return bands;
}

/** Writes the coefficients of f(R^-1 s), where `rgb` holds those of f as n² x 3 numbers. */
export function rotateCoefficients(order, bands, rgb, out) {
  for (let l = 0; l < order; ++l)
    for (let n = 0; n < 2 * l + 1; ++n)
      for (let channel = 0; channel < 3; ++channel) {
        let sum = 0;
        for (let m = 0; m < 2 * l + 1; ++m) sum += bands[l][m][n] * rgb[3 * (l * l + m) + channel];
        out[3 * (l * l + n) + channel] = sum;
      }
  return out;
}

/**
 * Projects a lat-long picture of light: row 0 lies at +Y, the middle looks along +X and right of it lies +Z. `texel`
 * returns the radiance of column x in row y as [r, g, b]. Values that are not finite count as black.
 */
export function projectEquirect(order, width, height, texel) {
  const out = new Float64Array(3 * order * order), basis = new Float64Array(order * order);
  for (let row = 0; row < height; ++row) {
    const top = (Math.PI * row) / height, bottom = (Math.PI * (row + 1)) / height;
    const solidAngle = ((2 * Math.PI) / width) * (Math.cos(top) - Math.cos(bottom));
    const theta = (top + bottom) / 2;
    for (let column = 0; column < width; ++column) {
      const phi = ((column + 0.5) / width - 0.5) * 2 * Math.PI;
      evaluateBasis(order, Math.sin(theta) * Math.cos(phi), Math.cos(theta), Math.sin(theta) * Math.sin(phi), basis);
      const [r, g, b] = texel(column, row);
      if (!Number.isFinite(r + g + b)) continue;
      for (let i = 0; i < basis.length; ++i) {
        const weight = basis[i] * solidAngle;
        out[3 * i] += weight * r;
        out[3 * i + 1] += weight * g;
        out[3 * i + 2] += weight * b;
      }
    }
  }
  return out;
}

/** Directions of the faces of a cube map in OpenGL's order, of texture coordinates s and t from -1 to 1. */
export const CUBE_FACES = [
  (s, t) => [1, -t, -s], (s, t) => [-1, -t, s], (s, t) => [s, 1, t], (s, t) => [s, -1, -t], (s, t) => [s, -t, 1],
  (s, t) => [-s, -t, -1],
];

/** Projects a cube map of light: six arrays of RGBA floats. */
export function projectCube(order, size, faces) {
  const out = new Float64Array(3 * order * order), basis = new Float64Array(order * order);
  faces.forEach((pixels, face) => {
    for (let i = 0; i < size * size; ++i) {
      const s = (2 * ((i % size) + 0.5)) / size - 1, t = (2 * (Math.floor(i / size) + 0.5)) / size - 1;
      const [x, y, z] = CUBE_FACES[face](s, t), length = Math.hypot(x, y, z);
      evaluateBasis(order, x / length, y / length, z / length, basis);
      const solidAngle = 4 / (size * size * length ** 3);
      for (let k = 0; k < basis.length; ++k)
        for (let c = 0; c < 3; ++c) out[3 * k + c] += basis[k] * solidAngle * pixels[4 * i + c];
    }
  });
  return out;
}

function legendre(l, t) {
  let before = 1, value = t;
  if (l <= 0) return before;
  for (let k = 2; k <= l; ++k) [before, value] = [value, ((2 * k - 1) * t * value - (k - 1) * before) / k];
  return value;
}

/** Returns coefficient l of a disc of radiance 1 about the polar axis, by the integral of P_l over its cap. */
export function discZonal(l, radius) {
  const half = Math.sin(radius / 2), cap = 2 * half * half;
  if (l === 0) return Math.sqrt(Math.PI) * cap;
  if (radius > 0.1) {
    const t = Math.cos(radius);
    return Math.sqrt(Math.PI / (2 * l + 1)) * (legendre(l - 1, t) - legendre(l + 1, t));
  }
  // The difference above cancels for small caps, so they use the series of P_l about 1.
  let term = 1, sum = 1;
  for (let k = 1; k <= l; ++k) {
    term *= ((-(l - k + 1) * (l + k)) / (k * k)) * (cap / 2);
    sum += term / (k + 1);
  }
  return Math.sqrt(Math.PI * (2 * l + 1)) * cap * sum;
}
