// Stage a for vectors and matrices, of any effect: multiplies each value of a vector with its coefficient of the
// light.
#include "vector_light.glsl"
#include "project_clusters.glsl"

vec4 projected(TransferRecord transfer, uint vector, uint output_index, uint light) {
#ifdef LAMBENT_ORDER
  uint columns = LAMBENT_ORDER * LAMBENT_ORDER;
#else
  uint columns = transfer.columns;
#endif
  return projectOnLight(transfer, vector, output_index, columns, light);
}
