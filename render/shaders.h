#pragma once

#include <string>
#include <utility>

/// GLSL of the renderer. All light is linear, also in reflections. Pictures have sRGB codes, which
/// shaders compute where this is cheapest.
namespace headpin::render::shaders {

/// The options of a program.
struct Variant {
  bool early = false;   ///< the sRGB code comes from the vertices
  bool lamps = false;   ///< light of lamps is computed at vertices
  bool shadow = false;  ///< shows shadows
  bool mirror = false;  ///< a floor with reflections
  int count = 0;        ///< of lamps
};

/// Functions of several shaders. One computes the sRGB code of a light, to a tenth of a code with
/// two roots, because powers would be the most expensive part of a shader. The other one is
/// Schlick's (1994) increase of reflection with the cosine of the viewing angle.
inline constexpr const char* kAsked = R"(
float schlick(float cosine) {
  float graze = 1.0 - max(cosine, 0.0);
  float graze2 = graze * graze;
  return graze2 * graze2 * graze;
}
vec3 code(vec3 x) {
  vec3 root = sqrt(x);
  vec3 curve = 0.833725 * root + 0.298132 * sqrt(root) - 0.0553072 * x - 0.0769088;
  return mix(curve, 12.92 * x, lessThan(x, vec3(0.0031308)));
}
)";

// A vertex's place in the grid of samples. Clip planes 1 to 4 are half a pixel outside of the
// picture; plane 0 is free.
inline constexpr const char* kPlaced = R"(
uniform vec3 grid_x;
uniform vec3 grid_y;
uniform vec3 edge;
out float gl_ClipDistance[5];
void place(vec4 p) {
  gl_ClipDistance[1] = edge.x * p.w + p.x;
  gl_ClipDistance[2] = edge.x * p.w - p.x;
  gl_ClipDistance[3] = edge.y * p.w + p.y;
  gl_ClipDistance[4] = edge.y * p.w - p.y;
  gl_Position = vec4(dot(grid_x.xy, p.xy), dot(grid_y.xy, p.xy), p.zw);
}
)";

// Lamps (Lambert, Blinn), light of the surroundings from above and below, and their reflection.
inline constexpr const char* kLight = R"(
uniform vec3 eye_W;
uniform vec3 sky;
uniform vec3 ground;
#if COUNT > 0
uniform vec3 lamp_p[COUNT];
uniform vec3 lamp_power[COUNT];
#endif
uniform float gloss;
vec3 light(vec3 p_W, vec3 n_W, vec3 colour) {
  vec3 n = normalize(n_W);
  vec3 v = normalize(eye_W - p_W);
  vec3 diffuse = mix(ground, sky, 0.5 + 0.5 * n.z);
  vec3 shine = vec3(0.0);
#if COUNT > 0
  for (int i = 0; i < COUNT; ++i) {
    vec3 l = lamp_p[i] - p_W;
    float d2 = dot(l, l);
    l *= inversesqrt(d2);
    vec3 power = lamp_power[i] / d2;
    diffuse += power * max(dot(n, l), 0.0);
    float s = max(dot(n, normalize(l + v)), 0.0);
    s *= s; s *= s; s *= s; s *= s; s *= s; s *= s;  // to the 64th
    shine += power * s;
  }
#endif
  float fresnel = 0.04 + 0.5 * schlick(dot(n, v));  // held down at the rim
  vec3 r = reflect(-v, n);
  shine += fresnel * mix(ground, sky, smoothstep(-0.2, 0.2, r.z));
  return colour * diffuse + gloss * shine;
}
)";

// The part of the light that is left in the shadow of items. On bodies, only where they face the
// light.
inline constexpr const char* kShade = R"(
uniform mat4 shadow_view;
uniform sampler2DShadow shadow_map;
uniform vec3 shadow_n;
uniform float shadow_depth;
float shaded(vec3 p_W) {
  vec4 s = shadow_view * vec4(p_W, 1.0);
  return shadow_depth * (1.0 - texture(shadow_map, s.xyz));
}
// Of a body, from beside its surface: its own far side, as coarse as texels, does not shade it there.
float left_of_light(vec3 p_W, vec3 n_W) {
  vec3 n = normalize(n_W);
  return 1.0 - smoothstep(0.0, 0.25, dot(n, shadow_n)) * shaded(p_W + 0.015 * n);
}
)";

inline constexpr const char* kMeshVertex = R"(
layout(location = 0) in vec3 p_G;
layout(location = 1) in vec3 n_G;
layout(location = 2) in vec3 colour_in;
uniform mat4 world;     // mesh to world
uniform mat4 turn;      // the same for normals
uniform mat4 to_clip;   // mesh to clip space
uniform vec3 tint;
uniform float lowest_z;
out vec3 p_W;
out vec3 n_W;
out vec3 colour;
void main() {
  vec4 p = world * vec4(p_G, 1.0);
  p_W = p.xyz;
  n_W = mat3(turn) * n_G;
  colour = tint * colour_in;
#ifdef LAMPS
  colour = light(p_W, n_W, colour);
#ifdef SHADOW
  colour *= left_of_light(p_W, n_W);
#endif
  colour = min(colour, vec3(1.0));
#endif
#ifdef EARLY
  colour = code(colour);
#endif
  gl_ClipDistance[0] = p.z - lowest_z;  // what is below a mirror is not seen in it
  place(to_clip * vec4(p_G, 1.0));
}
)";

inline constexpr const char* kLitFragment = R"(
in vec3 p_W;
in vec3 n_W;
in vec3 colour;
out vec4 result;
void main() {
  result = vec4(light(p_W, n_W, colour), 1.0);
#ifdef SHADOW
  result.rgb *= left_of_light(p_W, n_W);
#endif
  result.rgb = code(min(result.rgb, vec3(1.0)));
}
)";

inline constexpr const char* kBakedFragment = R"(
in vec3 p_W;
in vec3 n_W;
in vec3 colour;
out vec4 result;
void main() { result = vec4(colour, 1.0); }
)";

// Varnish reflects half of the light at most. A floor without reflections already has its sRGB
// code.
inline constexpr const char* kFloorFragment = R"(
in vec3 p_W;
in vec3 n_W;
in vec3 colour;
#ifdef MIRROR
uniform sampler2D mirrored;
uniform vec3 picture_u;
uniform vec3 picture_v;
#endif
out vec4 result;
void main() {
  float lit = 1.0;
#ifdef SHADOW
  lit = 1.0 - shaded(p_W);
#endif
#ifdef MIRROR
  vec3 at = vec3(gl_FragCoord.xy, 1.0);
  vec3 seen = texture(mirrored, vec2(dot(picture_u, at), dot(picture_v, at))).rgb;
  float share = mix(gloss, 0.5, schlick(dot(n_W, normalize(eye_W - p_W))));
  result = vec4(code(mix(colour * lit, seen, share)), 1.0);
#else
  result = vec4(colour * lit, 1.0);
#endif
}
)";

inline constexpr const char* kContactVertex = R"(
layout(location = 0) in vec3 p_in;
layout(location = 1) in vec3 n_in;
layout(location = 2) in vec4 ball_in;
uniform mat4 view;
out vec3 p_W;
out vec3 n_W;
out vec4 ball;
void main() {
  p_W = p_in;
  n_W = n_in;
  ball = ball_in;
  gl_ClipDistance[0] = 1.0;
  place(view * vec4(p_in, 1.0));
}
)";

// Share of the sky's cosine-weighted light that a ball keeps from a point of a plane:
// (r/d)^2 cos, minus the part that is too faint to draw. The target is multiplied by the rest.
inline constexpr const char* kContactFragment = R"(
in vec3 p_W;
in vec3 n_W;
in vec4 ball;
uniform float faint;
out vec4 result;
void main() {
  vec3 d = ball.xyz - p_W;
  float d2 = dot(d, d);
  float taken = ball.w * ball.w * max(dot(n_W, d), 0.0) * inversesqrt(d2) / d2;
  taken = clamp((taken - faint) / (1.0 - faint), 0.0, 0.95);
  result = vec4(vec3(pow(1.0 - taken, 1.0 / 2.2)), 1.0);
}
)";

inline constexpr const char* kDepthVertex = R"(#version 330 core
layout(location = 0) in vec3 p_G;
uniform mat4 to_clip;
void main() { gl_Position = to_clip * vec4(p_G, 1.0); }
)";

inline constexpr const char* kDepthFragment = R"(#version 330 core
void main() {}
)";

inline constexpr const char* kLabelFragment = R"(#version 330 core
uniform uint id;
out uint result;
void main() { result = id; }
)";

inline std::string shader(const Variant& variant, const char* body) {
  std::string text = "#version 330 core\n";
  for (const auto& [wanted, name] :
       {std::pair{variant.early, "EARLY"}, std::pair{variant.lamps, "LAMPS"},
        std::pair{variant.shadow, "SHADOW"}, std::pair{variant.mirror, "MIRROR"}}) {
    if (wanted) text += std::string("#define ") + name + "\n";
  }
  text += "#define COUNT " + std::to_string(variant.count) + "\n";
  return text + kAsked + kLight + (variant.shadow ? kShade : "") + body;
}

inline std::string vertex_shader(const Variant& variant, const char* body) {
  return shader(variant, (std::string(kPlaced) + body).c_str());
}

}  // namespace headpin::render::shaders
