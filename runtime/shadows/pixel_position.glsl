// Says where in view space a pixel of a surface is. Positions are computed in homogeneous coordinates whose w is not
// needed, so they have full precision, even where the depth buffer has little.

// The clip coordinates where the pixel is covered. The centre of a pixel on a contour may lie beside the triangle, whose
// plane is seen almost edge-on there: at the centre, that plane may be far from the body, out of its shadow and beside a
// lamp.
layout(location = 15) centroid in vec4 covered_clip;

vec3 coveredPosition(mat4 view_from_clip) { return (view_from_clip * covered_clip).xyz; }

// Returns the unit normal of the triangle, on the side of the eye. It is made of positions at the centres of pixels,
// which lie in the triangle's plane and a pixel apart; covered places may coincide. The cross product points to the eye,
// because the picture's axes and the direction to it are right-handed.
vec3 triangleNormal(mat4 view_from_clip, vec2 picture_size) {
  vec3 ndc = vec3(2.0 * gl_FragCoord.xy / picture_size, 2.0 * gl_FragCoord.z) - 1.0;
  vec3 center = (view_from_clip * (vec4(ndc, 1.0) / gl_FragCoord.w)).xyz;
  return localUnit(cross(dFdx(center), dFdy(center)));
}
