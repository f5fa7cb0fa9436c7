// Bounds how patches change the light that transfer brings (patch_room.hpp).
//
// known: the first output of transfer (E/pi, or band 0 of the light); change: the same of patches; by_bands: luminance
// of what patches say that transfer brings, below 0 if lamps have no part in the change. Where patches claim more than
// transfer knows of, they see more of a bright place than there is to see, such as a vertex of a ceiling that lies
// outside of its room, and the change is in proportion. Lamps bring light that transfer does not know of, so what they
// add stays. Returns the share of the change that is applied.
float shareOfChange(vec3 known, vec3 change, float by_bands) {
  const vec3 kLuminance = vec3(0.2126, 0.7152, 0.0722);
  if (by_bands >= 0.0 && dot(change, kLuminance) >= 0.0) return 1.0;
  return clamp(dot(known, kLuminance) / max(abs(by_bands), 1e-20), 0.0, 1.0);
}
