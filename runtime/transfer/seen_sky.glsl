// Tells how much of the sky a rough mirror sees, from the first bands of transfer without bounces and the weights of
// evaluate/seen_sky.hpp. Vectors are unit vectors in the group's frame.
#include "seen_sky_shared.h"

// Evaluates each of the first bands in direction d.
void seenBands(float c[kSeenCoefficients], vec3 d, out float bands[kSeenBands]) {
  float x = d.x, y = d.y, z = d.z, z2 = z * z;
  float c2 = x * x - y * y, s2 = 2.0 * x * y, c3 = x * c2 - y * s2, s3 = x * s2 + y * c2;
  float c4 = x * c3 - y * s3, s4 = x * s3 + y * c3;
  bands[0] = 0.282094792 * c[0];
  bands[1] = 0.488602512 * (y * c[1] + z * c[2] + x * c[3]);
  bands[2] = 0.546274215 * (s2 * c[4] + c2 * c[8]) + 1.09254843 * z * (y * c[5] + x * c[7]) +
             (0.946174696 * z2 - 0.315391565) * c[6];
  bands[3] = 0.59004359 * (s3 * c[9] + c3 * c[15]) + 1.44530572 * z * (s2 * c[10] + c2 * c[14]) +
             (2.285229 * z2 - 0.457045799) * (y * c[11] + x * c[13]) + z * (1.86588166 * z2 - 1.119529) * c[12];
  bands[4] = 0.625835735 * (s4 * c[16] + c4 * c[24]) + 1.77013077 * z * (s3 * c[17] + c3 * c[23]) +
             (3.31161144 * z2 - 0.473087348) * (s2 * c[18] + c2 * c[22]) +
             z * (4.6833258 * z2 - 2.00713963) * (y * c[19] + x * c[21]) +
             ((3.70249414 * z2 - 3.17356641) * z2 + 0.317356641) * c[20];
}

// Returns the share of the sky that is seen by a mirror. `frame` has the normal as its z axis and the mirrored
// direction in the plane of x and z; `axes` are those of the weights in that frame.
float seenShare(float c[kSeenCoefficients], float weights[kSeenWeights + 1u], vec3 axes[kSeenBands], mat3 frame) {
  float sum = 0.0;
  for (uint i = 0u; i < kSeenBands; ++i) {
    float bands[kSeenBands];
    seenBands(c, frame * axes[i], bands);
    for (uint l = i; l < kSeenBands; ++l) sum += weights[l * (l + 1u) / 2u + i] * bands[l];
  }
  return clamp(sum, 0.0, 1.0);
}

// Returns the share of E/pi under uniform light that comes straight from the sky, 0..1.
float seenShareOfAll(float c[kSeenCoefficients]) { return clamp(3.5449077 * c[0], 0.0, 1.0); }
