// The march through a volume, per pixel: the text of runtime/effects/volume/volume_march.glsl for one volume.
//   L = sum_k tau_k (1 - exp(-sigma_k d_k)) S_k + tau_end L_behind
// Within a step the density is that at its middle, and S that at the place where, on average, the step scatters.

export const VOLUME_VERTEX = /* glsl */ `
varying vec3 vView;
void main() {
  vView = (modelViewMatrix * vec4(position, 1.0)).xyz;
  gl_Position = projectionMatrix * vec4(vView, 1.0);
}`;

// y_i(d) of five bands, without the Condon-Shortley sign.
const BASIS = /* glsl */ `
void basisAt(vec3 d, out float y[25]) {
  float z2 = d.z * d.z, c2 = d.x * d.x - d.y * d.y, s2 = 2.0 * d.x * d.y;
  float c3 = d.x * c2 - d.y * s2, s3 = d.x * s2 + d.y * c2, c4 = d.x * c3 - d.y * s3, s4 = d.x * s3 + d.y * c3;
  float p31 = 2.285229 * z2 - 0.457045799, p42 = 3.31161144 * z2 - 0.473087348;
  float p41 = d.z * (4.6833258 * z2 - 2.00713963);
  y = float[25](0.282094792, 0.488602512 * d.y, 0.488602512 * d.z, 0.488602512 * d.x, 0.546274215 * s2,
    1.09254843 * d.z * d.y, 0.946174696 * z2 - 0.315391565, 1.09254843 * d.z * d.x, 0.546274215 * c2,
    0.59004359 * s3, 1.44530572 * d.z * s2, p31 * d.y, d.z * (1.86588166 * z2 - 1.119529), p31 * d.x,
    1.44530572 * d.z * c2, 0.59004359 * c3, 0.625835735 * s4, 1.77013077 * d.z * s3, p42 * s2, p41 * d.y,
    (3.70249414 * z2 - 3.17356641) * z2 + 0.317356641, p41 * d.x, p42 * c2, 1.77013077 * d.z * c3, 0.625835735 * c4);
}`;

/** `bands` of the light that arrives; 1: its mean. */
export const volumeFragment = (bands) => /* glsl */ `
precision highp sampler3D;
uniform sampler3D density, light, filled;
uniform highp sampler2D depth;
uniform mat4 projection, boxFromView;
uniform mat3 groupFromView;
uniform vec3 size, transferSize, lightSize, albedo;
uniform vec2 corner;        // of the picture's viewport, in pixels
uniform float densityScale; // extinction at density 1, per metre of the group
uniform float stepVoxels;
uniform int slabsZ;
varying vec3 vView;

const float FAR = 1e30, DEEP = 9.2103404; // exp(-DEEP) = 1e-4, behind which nothing is seen
const float BLOCK = 8.0;
const int MOST_BLOCKS = 1024, MOST_STEPS = 256;

float lostOf(float x) { return x < 0.02 ? x * (1.0 - x * (0.5 - x / 6.0)) : 1.0 - exp(-x); }
// Where, on average, a step of optical depth x scatters.
float meanPlace(float x) {
  return x < 0.3 ? 0.5 - x / 12.0 + x * x * x / 720.0 : 1.0 / x - 1.0 / (exp(min(x, 80.0)) - 1.0);
}
// A number in (0, 1] that depends on the pixel and not on the frame [Jarzynski and Olano 2020].
float jitterOf(uvec2 pixel) {
  uint state = (pixel.x + 65536u * pixel.y) * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  word = (word >> 22u) ^ word;
  return (float(word >> 8u) + 1.0) / 16777216.0;
}
${bands > 1 ? BASIS : ''}

// The light that is scattered towards the eye at a place. Only voxels that have light are interpolated.
vec3 scatteredAt(vec3 place, vec3 towards) {
  // A slab of the texture holds an output; places are clamped to it, so that the next one is not mixed in.
  vec3 voxel = clamp(place * transferSize, vec3(0.5), transferSize - 0.5);
  vec4 sum = textureLod(light, voxel / lightSize, 0.0);
  ${bands > 1 ? /* glsl */ `float y[25];
  basisAt(towards, y);
  sum.rgb *= y[0];
  for (int j = 1; j < ${bands * bands}; ++j) {
    vec3 slab = vec3(float(j / slabsZ), 0.0, float(j % slabsZ));
    sum.rgb += y[j] * textureLod(light, (voxel + slab * transferSize) / lightSize, 0.0).rgb;
  }` : ''}
  return sum.a > 0.0 ? sum.rgb / sum.a : vec3(0.0);
}

float viewZ(float depth) {
  vec2 p = vec2(projection[2][2], projection[3][2]);
  return isOrthographic ? (depth - p.y) / p.x : -p.y / (depth + p.x);
}

void main() {
  vec3 eye = isOrthographic ? vec3(vView.xy, 0.0) : vec3(0.0);
  vec3 ahead = isOrthographic ? vec3(0.0, 0.0, -1.0) : normalize(vView);
  float behind = texelFetch(depth, ivec2(gl_FragCoord.xy - corner), 0).r;
  float stop = behind < 1.0 ? viewZ(2.0 * behind - 1.0) / ahead.z : FAR;
  vec3 origin = (boxFromView * vec4(eye, 1.0)).xyz, direction = mat3(boxFromView) * ahead;
  vec3 inGroup = groupFromView * ahead;
  float metres = length(inGroup), speed = length(size * direction), voxel = 1.0 / speed;
  // Rays that are nearly parallel to a face never cross it.
  bvec3 parallel = lessThan(abs(size * direction), vec3(1e-6 * speed));
  direction = mix(direction, vec3(0.0), parallel);
  vec3 divisor = mix(direction, vec3(1.0), parallel), first = -origin / divisor, second = (1.0 - origin) / divisor;
  bvec3 between = lessThanEqual(abs(origin - 0.5), vec3(0.5));
  vec3 enters = mix(min(first, second), mix(vec3(FAR), vec3(-FAR), between), parallel);
  vec3 leaves = mix(max(first, second), mix(vec3(-FAR), vec3(FAR), between), parallel);
  float t = max(viewZ(-1.0) / ahead.z, max(enters.x, max(enters.y, enters.z)));
  float last = min(stop, min(leaves.x, min(leaves.y, leaves.z)));

  // The ray goes from block to block by whole numbers, because rays along a face of blocks would crawl otherwise.
  vec3 blocks = size / BLOCK;
  ivec3 lastBlock = (ivec3(size) - 1) / int(BLOCK);
  ivec3 block = clamp(ivec3(floor((origin + t * direction) * blocks)), ivec3(0), lastBlock);
  vec3 border = vec3(block) + vec3(greaterThan(direction, vec3(0.0)));
  vec3 exits = mix((border / blocks - origin) / divisor, vec3(FAR), parallel), strides = 1.0 / (blocks * abs(divisor));
  float jitter = jitterOf(uvec2(gl_FragCoord.xy - corner)), depthSum = 0.0;
  vec3 sum = vec3(0.0);
  for (int crossed = 0; crossed < MOST_BLOCKS && t < last && depthSum <= DEEP; ++crossed) {
    float end = min(last, min(exits.x, min(exits.y, exits.z)));
    if (end > t && texelFetch(filled, block, 0).r > 0.0) {
      float steps = clamp(ceil((end - t) / (stepVoxels * voxel) - 1e-3), 1.0, float(MOST_STEPS));
      float width = (end - t) / steps;
      for (float k = 0.0; k <= steps && depthSum <= DEEP; k += 1.0) {
        float a = max(t, t + (k - 1.0 + jitter) * width), b = min(end, t + (k + jitter) * width);
        if (b <= a) continue;
        float thick = densityScale * metres * textureLod(density, origin + 0.5 * (a + b) * direction, 0.0).r * (b - a);
        if (thick <= 0.0) continue;
        float place = a + meanPlace(thick) * (b - a);
        sum += exp(-depthSum) * lostOf(thick) * scatteredAt(origin + place * direction, inGroup / metres);
        depthSum += thick;
      }
    }
    t = max(t, end);
    bvec3 next = exits.x <= min(exits.y, exits.z) ? bvec3(true, false, false)
      : exits.y <= exits.z ? bvec3(false, true, false) : bvec3(false, false, true);
    block += ivec3(next) * ivec3(sign(direction));
    exits += vec3(next) * strides;
    if (any(lessThan(block, ivec3(0))) || any(greaterThan(block, lastBlock))) break;
  }
  float covered = lostOf(depthSum);
  if (depthSum == 0.0) discard;
  // Colours are mapped for the screen as three does it, before they are multiplied with what they cover.
  gl_FragColor = vec4(albedo * sum / covered, covered);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
  gl_FragColor.rgb *= gl_FragColor.a;
}`;
