// Writes the id of the surface that a subsample sees.
layout(location = 0) flat in uint surface_id;
layout(location = 0) out uint id;

void main() {
  id = surface_id;
}
