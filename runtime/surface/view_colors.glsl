// Makes colours that stand for numbers. The functions return sRGB-coded colours as they shall be seen; displayed()
// converts them to the picture's linear values.

// Returns viridis (van der Walt and Smith 2015), which has even steps of lightness, by M. Zucker's fitted polynomial
// of degree 6 (https://www.shadertoy.com/view/WlfXRN, CC0).
vec3 viridis(float t) {
  const vec3 c0 = vec3(0.2777273272234177, 0.005407344544966578, 0.3340998053353061);
  const vec3 c1 = vec3(0.1050930431085774, 1.404613529898575, 1.384590162594685);
  const vec3 c2 = vec3(-0.3308618287255563, 0.214847559468213, 0.09509516302823659);
  const vec3 c3 = vec3(-4.634230498983486, -5.799100973351585, -19.33244095627987);
  const vec3 c4 = vec3(6.228269936347081, 14.17993336680509, 56.69055260068105);
  const vec3 c5 = vec3(4.776384997670288, -13.74514537774601, -65.35303263337234);
  const vec3 c6 = vec3(-5.435455855934631, 4.645852612178535, 26.3124352495832);
  t = clamp(t, 0.0, 1.0);
  return clamp(c0 + t * (c1 + t * (c2 + t * (c3 + t * (c4 + t * (c5 + t * c6))))), 0.0, 1.0);
}

// Hashes by PCG (Jarzynski and Olano 2020).
uint hashed(uint v) {
  v = v * 747796405u + 2891336453u;
  v = ((v >> ((v >> 28u) + 4u)) ^ v) * 277803737u;
  return (v >> 22u) ^ v;
}

// Returns a colour for a number. Hues run all round; lightness and saturation stay in a range where neighbours differ
// and nothing is lost in black.
vec3 distinctColor(uint id) {
  uint h = hashed(id);
  float hue = float(h & 0xffffu) / 65536.0, saturation = 0.45 + 0.4 * float(h >> 16u & 0xffu) / 255.0,
        value = 0.6 + 0.38 * float(h >> 24u) / 255.0;
  vec3 ramp = clamp(abs(fract(hue + vec3(0.0, 2.0 / 3.0, 1.0 / 3.0)) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
  return value * mix(vec3(1.0), ramp, saturation);
}

// Inverts the sRGB transfer function (IEC 61966-2-1).
vec3 displayed(vec3 coded) {
  return mix(pow((coded + 0.055) / 1.055, vec3(2.4)), coded / 12.92, lessThanEqual(coded, vec3(0.04045)));
}
