// Light and its change together. What is below 0 already, by coding errors, stays; a change takes no light that is not
// there (overlapping shadows, ringing).
vec3 withChange(vec3 light, vec3 change) { return max(light + change, min(light, vec3(0.0))); }
