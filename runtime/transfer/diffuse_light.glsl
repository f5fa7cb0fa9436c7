// Returns E/pi at a normal from light of bands 0..2, both in the group's frame: E/pi = sum_j (A_l/pi) y_j(n) l_j with
// A = pi, 2pi/3, pi/4 (Ramamoorthi and Hanrahan 2001).
vec3 diffuseLight(vec3 light[9], vec3 n) {
  return 0.28209479 * light[0] +
         0.32573501 * (n.y * light[1] + n.z * light[2] + n.x * light[3]) +
         0.27313711 * (n.x * n.y * light[4] + n.y * n.z * light[5] + n.x * n.z * light[7]) +
         0.07884789 * (3.0 * n.z * n.z - 1.0) * light[6] +
         0.13656855 * (n.x * n.x - n.y * n.y) * light[8];
}
