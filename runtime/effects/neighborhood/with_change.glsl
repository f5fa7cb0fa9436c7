// Returns light plus its change. Light that coding errors have made negative stays as it is; otherwise a change takes
// no more light than there is (overlapping shadows, ringing).
vec3 withChange(vec3 light, vec3 change) { return max(light + change, min(light, vec3(0.0))); }
