// Gathers light along a ray through up to LAMBENT_VOLUMES volumes at once. It holds the mathematics only and no
// bindings.
//
//   L = sum_k tau_k (1 - exp(-sigma_k d_k)) S_k + tau_end L_behind,   tau_k = exp(-sum_j<k sigma_j d_j)
//
// The products telescope: with S = 1 and L_behind = 1 the sum is 1 for any steps. Within a step the density is that
// at its middle, and S that at the place where, on average, the step scatters; so a step is exact where density is
// constant and S linear, at any density. Where volumes overlap, their extinctions add up.
//
// S is the radiance that arrives, convolved with the phase function. The ray runs along d, so the light that reaches
// its start travels along -d, and light that arrives from s travels along -s. Hence Henyey-Greenstein's cosine is
// dot(s, d), and
//   S(d) = int p(dot(s, d)) L(s) ds = sum_lm g^l L_lm y_lm(d).
// With g > 0 a medium is bright when one looks towards the light.
#include "volume_shared.h"

const float kInfinity = 1e30;
const float kDeep = 9.2103404;  // exp(-kDeep) = 1e-4, behind which nothing is seen
const int kMaxIntervals = 8192;  // more than any ray meets, of intervals and of blocks

// Return density and light of volume v, looked up by place in its texture, 0..1.
float densityAt(int v, vec3 place);
vec4 lightAt(int v, vec3 place);
float blockMaximumAt(uint block);  // over the blocks of all volumes

// Returns 1 - exp(-x).
float lostOf(float x) { return x < 0.02 ? x * (1.0 - x * (0.5 - x / 6.0)) : 1.0 - exp(-x); }

// Returns where, on average, a step of optical depth x scatters: int t exp(-x t) dt / int exp(-x t) dt.
float meanPlace(float x) {
  return x < 0.3 ? 0.5 - x / 12.0 + x * x * x / 720.0 : 1.0 / x - 1.0 / (exp(min(x, 80.0)) - 1.0);
}

// Holds the state of a ray in one volume.
struct VolumeRay {
  vec3 origin;     // in the box from 0 to 1
  vec3 direction;  // of the box, per metre of the ray
  vec3 towards;    // unit vector, group frame
  float metres;    // metres of the group per metre of the ray
  float enter;     // metres; the ray misses the volume if it is not below `leave`
  float leave;
  float voxel;  // metres along the ray that count as a voxel's length
  // These hold the block that the ray is in, and where the ray leaves it along each axis.
  ivec3 block;
  ivec3 last_block;
  vec3 exits;
  vec3 strides;
};

vec3 rotated(vec4 rows[3], vec3 v) { return vec3(dot(rows[0].xyz, v), dot(rows[1].xyz, v), dot(rows[2].xyz, v)); }

VolumeRay enterVolume(MarchRecord record, vec3 origin_vs, vec3 dir_vs, float begin) {
  VolumeRay ray;
  ray.origin = rotated(record.box_from_view, origin_vs) +
               vec3(record.box_from_view[0].w, record.box_from_view[1].w, record.box_from_view[2].w);
  ray.direction = rotated(record.box_from_view, dir_vs);
  vec3 in_group = rotated(record.group_from_view, dir_vs);
  ray.metres = length(in_group);
  ray.towards = in_group / ray.metres;
  vec3 size = vec3(record.size);
  float speed = length(size * ray.direction);
  ray.voxel = 1.0 / speed;
  // Rays that are nearly parallel to a face are treated as parallel and never cross it.
  bvec3 parallel = lessThan(abs(size * ray.direction), vec3(1e-6 * speed));
  ray.direction = mix(ray.direction, vec3(0.0), parallel);
  vec3 divisor = mix(ray.direction, vec3(1.0), parallel);
  vec3 first = -ray.origin / divisor, second = (1.0 - ray.origin) / divisor;
  // A ray parallel to two faces is either always or never between them.
  bvec3 between = lessThanEqual(abs(ray.origin - 0.5), vec3(0.5));
  vec3 enter = mix(min(first, second), mix(vec3(kInfinity), vec3(-kInfinity), between), parallel);
  vec3 leave = mix(max(first, second), mix(vec3(-kInfinity), vec3(kInfinity), between), parallel);
  ray.enter = max(begin, max(enter.x, max(enter.y, enter.z)));
  ray.leave = min(leave.x, min(leave.y, leave.z));
  vec3 blocks = size / float(kBlock);
  ray.last_block = ivec3((record.size - 1u) / kBlock);
  ray.block = clamp(ivec3(floor((ray.origin + ray.enter * ray.direction) * blocks)), ivec3(0), ray.last_block);
  vec3 border = vec3(ray.block) + vec3(greaterThan(ray.direction, vec3(0.0)));
  ray.exits = mix((border / blocks - ray.origin) / divisor, vec3(kInfinity), parallel);
  ray.strides = 1.0 / (blocks * abs(divisor));
  return ray;
}

// Follows the ray into the block that contains it at t. Returns false if it has left the volume.
bool followBlocks(inout VolumeRay ray, float t) {
  for (int crossed = 0; crossed < kMaxIntervals; ++crossed) {
    if (!(min(ray.exits.x, min(ray.exits.y, ray.exits.z)) <= t)) return true;
    bvec3 next = bvec3(false, false, true);
    if (ray.exits.x <= min(ray.exits.y, ray.exits.z))
      next = bvec3(true, false, false);
    else if (ray.exits.y <= ray.exits.z)
      next = bvec3(false, true, false);
    ray.block += ivec3(next) * ivec3(sign(ray.direction));
    ray.exits += vec3(next) * ray.strides;
    if (any(lessThan(ray.block, ivec3(0))) || any(greaterThan(ray.block, ray.last_block))) return false;
  }
  return false;
}

bool blockFilled(VolumeRay ray, uint first_block) {
  uvec3 block = uvec3(ray.block), count = uvec3(ray.last_block + 1);
  return blockMaximumAt(first_block + block.x + count.x * (block.y + count.y * block.z)) > 0.0;
}

// Returns the extinction per metre of the ray at t.
float extinctionAt(int v, float density_scale, VolumeRay ray, float t) {
  return density_scale * ray.metres * densityAt(v, ray.origin + t * ray.direction);
}

#if LAMBENT_BANDS > 1
// Evaluates y_i(d), without the Condon-Shortley sign.
void basisAt(vec3 d, uint bands, out float y[LAMBENT_BANDS * LAMBENT_BANDS]) {
  float z2 = d.z * d.z;
  y[0] = 0.282094792;
  y[1] = 0.488602512 * d.y;
  y[2] = 0.488602512 * d.z;
  y[3] = 0.488602512 * d.x;
#if LAMBENT_BANDS > 2
  float c2 = d.x * d.x - d.y * d.y, s2 = 2.0 * d.x * d.y;
  y[4] = 0.546274215 * s2;
  y[5] = 1.09254843 * d.z * d.y;
  y[6] = 0.946174696 * z2 - 0.315391565;
  y[7] = 1.09254843 * d.z * d.x;
  y[8] = 0.546274215 * c2;
#endif
#if LAMBENT_BANDS > 3
  float c3 = d.x * c2 - d.y * s2, s3 = d.x * s2 + d.y * c2;
  float p31 = 2.285229 * z2 - 0.457045799;
  y[9] = 0.59004359 * s3;
  y[10] = 1.44530572 * d.z * s2;
  y[11] = p31 * d.y;
  y[12] = d.z * (1.86588166 * z2 - 1.119529);
  y[13] = p31 * d.x;
  y[14] = 1.44530572 * d.z * c2;
  y[15] = 0.59004359 * c3;
#endif
#if LAMBENT_BANDS > 4
  float c4 = d.x * c3 - d.y * s3, s4 = d.x * s3 + d.y * c3;
  float p41 = d.z * (4.6833258 * z2 - 2.00713963), p42 = 3.31161144 * z2 - 0.473087348;
  y[16] = 0.625835735 * s4;
  y[17] = 1.77013077 * d.z * s3;
  y[18] = p42 * s2;
  y[19] = p41 * d.y;
  y[20] = (3.70249414 * z2 - 3.17356641) * z2 + 0.317356641;
  y[21] = p41 * d.x;
  y[22] = p42 * c2;
  y[23] = 1.77013077 * d.z * c3;
  y[24] = 0.625835735 * c4;
#endif
#if LAMBENT_BANDS > 5
  float c5 = d.x * c4 - d.y * s4, s5 = d.x * s4 + d.y * c4;
  float p51 = (9.51187968 * z2 - 6.34125312) * z2 + 0.452946651;
  float p52 = d.z * (7.19030518 * z2 - 2.39676839), p53 = 4.40314469 * z2 - 0.489238299;
  y[25] = 0.656382057 * s5;
  y[26] = 2.07566231 * d.z * s4;
  y[27] = p53 * s3;
  y[28] = p52 * s2;
  y[29] = p51 * d.y;
  y[30] = d.z * ((7.36787031 * z2 - 8.18652257) * z2 + 1.75425484);
  y[31] = p51 * d.x;
  y[32] = p52 * c2;
  y[33] = p53 * c3;
  y[34] = 2.07566231 * d.z * c4;
  y[35] = 0.656382057 * c5;
#endif
}
#endif

// Returns S where the ray is at t. It interpolates only between voxels that have light.
vec3 scatteredAt(int v, MarchRecord record, VolumeRay ray, float t) {
  vec3 transfer_size = vec3(record.transfer_size), light_size = vec3(record.light_size);
  // Within half a voxel of a slab's face, the place is clamped to the slab's last voxel, so that the next slab is not
  // mixed in.
  vec3 place = clamp((ray.origin + t * ray.direction) * transfer_size, vec3(0.5), transfer_size - 0.5);
  vec4 light = lightAt(v, place / light_size);
#if LAMBENT_BANDS > 1
  if (record.outputs > 1u) {
    float y[LAMBENT_BANDS * LAMBENT_BANDS];
    basisAt(ray.towards, LAMBENT_BANDS, y);
    vec3 sum = y[0] * light.rgb;
    for (int j = 1; j < LAMBENT_BANDS * LAMBENT_BANDS; ++j) {
      if (uint(j) >= record.outputs) break;
      vec3 slab = vec3(float(uint(j) / record.slabs_z), 0.0, float(uint(j) % record.slabs_z));
      sum += y[j] * lightAt(v, (place + slab * transfer_size) / light_size).rgb;
    }
    light = vec4(sum, light.a);
  }
#endif
  return light.a > 0.0 ? light.rgb / light.a : vec3(0.0);
}

// Returns what was gathered up to each of the stops, which must rise: scattered radiance, and optical depth. A step
// is `step_voxels` voxels of the finest volume there; the first one ends `jitter` (0..1] of a step behind each
// block's border.
void marchVolumes(MarchRecord records[LAMBENT_VOLUMES], VolumeRay rays[LAMBENT_VOLUMES], float stops[LAMBENT_STOPS],
                  float step_voxels, float jitter, out vec4 gathered[LAMBENT_STOPS]) {
  vec4 sum = vec4(0.0);
  float t = kInfinity, last = -kInfinity;
  for (int v = 0; v < LAMBENT_VOLUMES; ++v) {
    if (rays[v].enter >= rays[v].leave) continue;
    t = min(t, rays[v].enter);
    last = max(last, rays[v].leave);
  }
  int stop = 0;
  for (int interval = 0; interval < kMaxIntervals; ++interval) {
    // There are at most two stops; indexing them dynamically would cost a trip to memory.
    bool ended = sum.a > kDeep || t >= last;
    if (stop == 0 && (ended || t >= stops[0])) {
      gathered[0] = sum;
      stop = 1;
    }
    if (stop == 1 && LAMBENT_STOPS == 2 && (ended || t >= stops[LAMBENT_STOPS - 1])) {
      gathered[LAMBENT_STOPS - 1] = sum;
      stop = 2;
    }
    if (stop == LAMBENT_STOPS) return;
    // The interval ends where a volume begins or ends, or where the ray enters another block.
    float end = min(stop == 0 ? stops[0] : stops[LAMBENT_STOPS - 1], last), width = kInfinity;
    uint filled = 0u;
    for (int v = 0; v < LAMBENT_VOLUMES; ++v) {
      if (t >= rays[v].leave) continue;
      if (t < rays[v].enter) {
        end = min(end, rays[v].enter);
        continue;
      }
      if (!followBlocks(rays[v], t)) {
        rays[v].leave = t;
        continue;
      }
      end = min(min(end, rays[v].leave), min(rays[v].exits.x, min(rays[v].exits.y, rays[v].exits.z)));
      if (!blockFilled(rays[v], records[v].first_block)) continue;
      filled |= 1u << v;
      width = min(width, rays[v].voxel);
    }
    if (filled != 0u) {
      float steps = clamp(ceil((end - t) / (step_voxels * width) - 1e-3), 1.0, float(kMostSteps));
      width = (end - t) / steps;
      if (jitter < 1.0) steps += 1.0;
      for (float k = 0.0; k < steps && sum.a <= kDeep; k += 1.0) {
        float a = max(t, t + (k - 1.0 + jitter) * width), b = min(end, t + (k + jitter) * width);
        float extinction[LAMBENT_VOLUMES], all = 0.0;
        for (int v = 0; v < LAMBENT_VOLUMES; ++v) {
          extinction[v] = (filled >> v & 1u) != 0u ? extinctionAt(v, records[v].density_scale, rays[v], 0.5 * (a + b)) : 0.0;
          all += extinction[v];
        }
        float depth = all * (b - a);
        if (!(depth > 0.0)) continue;
        float place = a + meanPlace(depth) * (b - a);
        vec3 light = vec3(0.0);
        for (int v = 0; v < LAMBENT_VOLUMES; ++v) {
          if (extinction[v] == 0.0) continue;
          light += extinction[v] / all * records[v].albedo * scatteredAt(v, records[v], rays[v], place);
        }
        sum += vec4(exp(-sum.a) * lostOf(depth) * light, depth);
      }
    }
    t = end;
  }
  if (stop == 0) gathered[0] = sum;
  gathered[LAMBENT_STOPS - 1] = sum;
}
