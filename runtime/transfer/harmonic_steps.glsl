// The steps of the recurrences by which harmonics of a direction are evaluated. They are Cartesian, so the poles are
// ordinary points (docs/conventions.md: no Condon-Shortley sign).

const float kConstantHarmonic = 0.28209479177387814;  // y_00

// Steps to the order m > 0: c and s are Re and Im of (x + iy)^m, and `sectoral` is y_mm without them, with sqrt(2) inside.
void stepOrder(vec3 direction, int m, inout float c, inout float s, inout float sectoral) {
  float next_c = direction.x * c - direction.y * s;
  s = direction.x * s + direction.y * c;
  c = next_c;
  sectoral *= m == 1 ? sqrt(3.0) : sqrt(float(2 * m + 1) / float(2 * m));
}

// Steps to the band l > m: p is y_lm without c or s, and `before` is that of the band below.
void stepBand(float z, int l, int m, inout float p, inout float before) {
  float z_factor = sqrt(float(4 * l * l - 1) / float(l * l - m * m));
  float back = l == m + 1 ? 0.0
                          : z_factor * sqrt(float((l - 1) * (l - 1) - m * m) / float(4 * (l - 1) * (l - 1) - 1));
  float next = z_factor * z * p - back * before;
  before = p;
  p = next;
}
