// Writes the radiance of the triangle.
layout(location = 0) flat in vec3 radiance;
layout(location = 0) out vec4 color;

void main() {
  color = vec4(radiance, 1.0);
}
