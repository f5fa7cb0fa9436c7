// A program with a window and things of its own, which draws a bundle among them, in the same HDR colour and depth. Usage:
// show BUNDLE [LIGHT [PICTURE.ppm]]; with a picture it draws one frame unseen, and writes it.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <epoxy/gl.h>
#include <GLFW/glfw3.h>
#include <lambent/renderer.hpp>

using lambent::Matrix4, lambent::Vec3;

static const char* kCubeVertex = R"(#version 450
layout(location = 0) uniform mat4 clip_from_world; layout(location = 1) uniform vec4 place; out vec3 normal;
void main() {  // 36 corners of a cube, without buffers
  int face = gl_VertexID / 6, axis = face / 2; vec2 uv = vec2(ivec2(0x32, 0x2c) >> gl_VertexID % 6 & 1) * 2 - 1;
  float side = face % 2 * 2 - 1; vec3 p; p[axis] = side; p[(axis + 1) % 3] = uv.x; p[(axis + 2) % 3] = uv.y;
  normal = vec3(0); normal[axis] = side; gl_Position = clip_from_world * vec4(place.xyz + place.w * p, 1); })";
static const char* kCubeFragment = R"(#version 450
in vec3 normal; out vec4 color; void main() { color = vec4(vec3(0.9, 0.5, 0.05) * (0.6 + 0.4 * normal.y), 1); })";
static const char* kScreenVertex = R"(#version 450
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); })";
static const char* kScreenFragment = R"(#version 450
layout(binding = 0) uniform sampler2D hdr; out vec4 color;
void main() { vec3 c = texelFetch(hdr, ivec2(gl_FragCoord.xy), 0).rgb; color = vec4(pow(c / (1 + c), vec3(1 / 2.2)), 1); })";

static GLuint program(const char* vertex, const char* fragment) {
  const GLuint linked = glCreateProgram();
  for (const auto& [kind, text] : {std::pair{GL_VERTEX_SHADER, vertex}, {GL_FRAGMENT_SHADER, fragment}}) {
    const GLuint shader = glCreateShader(GLenum(kind));
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    glAttachShader(linked, shader);
  }
  glLinkProgram(linked);
  return linked;
}

static Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
static float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
static Vec3 unit(Vec3 a) {
  const float l = std::sqrt(dot(a, a));
  return {a.x / l, a.y / l, a.z / l};
}

static Matrix4 lookAt(Vec3 eye, Vec3 at) {
  const Vec3 z = unit(eye - at), x = unit(cross({0, 1, 0}, z)), y = cross(z, x);
  return {x.x, y.x, z.x, 0, x.y, y.y, z.y, 0, x.z, y.z, z.z, 0, -dot(x, eye), -dot(y, eye), -dot(z, eye), 1};
}
static Matrix4 perspective(float fov_rad, float aspect, float near, float far) {
  const float f = 1 / std::tan(fov_rad / 2);
  return {f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0};
}
static Matrix4 operator*(const Matrix4& a, const Matrix4& b) {
  Matrix4 c{};
  for (int i = 0; i < 64; ++i) c[i / 16 * 4 + i % 4] += a[i / 4 % 4 * 4 + i % 4] * b[i / 16 * 4 + i / 4 % 4];
  return c;
}

static int fail(const lambent::Failure& failure) { return std::fprintf(stderr, "show: %s\n", failure.line().c_str()), 1; }

int main(int count, char** words) {
  if (count < 2) return std::fprintf(stderr, "usage: show BUNDLE [LIGHT [PICTURE.ppm]]\n"), 2;
  const char* picture = count > 3 ? words[3] : nullptr;
  const int width = 960, height = 540;
  if (!glfwInit()) return std::fprintf(stderr, "show: no display\n"), 1;
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_RESIZABLE, GLFW_FALSE);
  glfwWindowHint(GLFW_VISIBLE, picture ? GLFW_FALSE : GLFW_TRUE);
  GLFWwindow* window = glfwCreateWindow(width, height, "A program of its own", nullptr, nullptr);
  if (!window) return std::fprintf(stderr, "show: no window with OpenGL 4.5\n"), 1;
  glfwMakeContextCurrent(window);

  int result = 0;
  {  // what Lambent and we own of OpenGL ends before the context
    auto scene = lambent::Scene::create();
    if (!scene) return fail(scene.failure());
    if (const auto bundle = scene->open(words[1]); !bundle) return fail(bundle.failure());
    if (const auto lit = scene->setEnvironment({count > 2 ? words[2] : "constant:0.6,0.7,0.9"}); !lit) return fail(lit.failure());
    auto renderer = lambent::Renderer::create();
    if (!renderer) return fail(renderer.failure());
    if (const auto loaded = picture ? scene->finishLoading() : lambent::Expected<void>(); !loaded) return fail(loaded.failure());
    const auto [low, high] = scene->bounds();
    const Vec3 center = {(low.x + high.x) / 2, (low.y + high.y) / 2, (low.z + high.z) / 2};
    const float radius = std::sqrt(dot(high - low, high - low)) / 2;
    const auto lamp = scene->addLight(
        {.position = {center.x, high.y + radius / 2, center.z}, .color = {1.0f, 0.8f, 0.6f}, .strength = 20.0f, .radius = radius / 10});
    if (!lamp) return fail(lamp.failure());
    const auto bodies = scene->bodies();  // what does not move comes first

    GLuint textures[2], target, no_vertices;
    glCreateTextures(GL_TEXTURE_2D, 2, textures);
    glTextureStorage2D(textures[0], 1, GL_RGBA16F, width, height);
    glTextureStorage2D(textures[1], 1, GL_DEPTH_COMPONENT32F, width, height);
    glCreateFramebuffers(1, &target);
    glNamedFramebufferTexture(target, GL_COLOR_ATTACHMENT0, textures[0], 0);
    glNamedFramebufferTexture(target, GL_DEPTH_ATTACHMENT, textures[1], 0);
    glCreateVertexArrays(1, &no_vertices);
    glBindVertexArray(no_vertices);
    const GLuint cube = program(kCubeVertex, kCubeFragment), screen = program(kScreenVertex, kScreenFragment);

    while (result == 0 && !glfwWindowShouldClose(window)) {
      const float time = picture ? 0.8f : float(glfwGetTime());
      const Vec3 eye = {center.x + 1.7f * radius * std::sin(0.3f * time), center.y + 0.8f * radius,
                        center.z + 1.7f * radius * std::cos(0.3f * time)};
      const lambent::Camera camera = {lookAt(eye, center), perspective(0.7f, float(width) / height, radius / 50, radius * 10)};
      const float far = 1, black[4] = {};
      glBindFramebuffer(GL_FRAMEBUFFER, target);
      glViewport(0, 0, width, height);
      glClearBufferfv(GL_COLOR, 0, black);
      glClearBufferfv(GL_DEPTH, 0, &far);
      glEnable(GL_DEPTH_TEST);
      glUseProgram(cube);  // ours first: Lambent's surfaces are hidden by the cube, and hide it
      const Matrix4 clip_from_world = camera.clip_from_view * camera.view_from_world;
      glUniformMatrix4fv(0, 1, GL_FALSE, clip_from_world.data());
      glUniform4f(1, center.x + radius / 3 * std::sin(time), center.y, center.z + radius / 3 * std::cos(time), radius / 8);
      glDrawArrays(GL_TRIANGLES, 0, 36);
      Matrix4 place = bodies.back().world_from_body;
      place[13] += radius / 10 * std::sin(3 * time);  // up and down
      if (bodies.size() > 1 && !scene->place(bodies.back().id, place)) result = 1;
      if (const auto drawn = renderer->draw(*scene, camera, {textures[0], textures[1]}); !drawn) result = fail(drawn.failure());
      glDisable(GL_DEPTH_TEST);
      glBindFramebuffer(GL_FRAMEBUFFER, 0);
      glUseProgram(screen);
      glBindTextureUnit(0, textures[0]);
      glDrawArrays(GL_TRIANGLES, 0, 3);
      if (picture) {
        std::vector<unsigned char> pixels(3 * width * height);
        glPixelStorei(GL_PACK_ALIGNMENT, 1);
        glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
        std::FILE* file = std::fopen(picture, "wb");
        if (!file) return std::fprintf(stderr, "show: cannot write %s\n", picture), 1;
        std::fprintf(file, "P6 %d %d 255\n", width, height);
        for (int y = height; y-- > 0;) std::fwrite(&pixels[std::size_t(3 * width * y)], 3, width, file);
        if (std::fclose(file) != 0) result = 1;
        break;
      }
      scene->turnEnvironment(10 * time);
      glfwSwapBuffers(window);
      glfwPollEvents();
    }
  }
  glfwTerminate();
  return result;
}
