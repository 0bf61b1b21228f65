#include "shaders.h"

#include <string>

namespace perennial::park {
namespace {

const char* const kVersion = "#version 130\n";

/// Light that reaches the camera from a surface: sun with shadow, sky, light thrown back by the ground,
/// searchlight, then haze on the way. Light on a surface: sun, sky, light thrown back by the ground,
/// searchlight; and haze on the way to the camera.
const char* const kLight = R"(
uniform mat4 shadow_matrix;
uniform vec3 camera, camera_forward, to_sun, sun, sky, horizon;
uniform float searchlight, haze, exposure, snow, wetness, sun_visible;

vec3 shadow_coordinates(vec3 position, vec3 normal) {
  return (shadow_matrix * vec4(position + 0.03 * normal, 1.0)).xyz;
}

// What comes from everywhere, and from the searchlight beside the camera, which throws no shadow that it could see.
vec3 steady_light(vec3 normal, vec3 position) {
  vec3 light = sky * (0.62 + 0.38 * normal.z) + sun * (0.05 * (1.0 - normal.z) * max(to_sun.z, 0.0));
  if (searchlight > 0.0) {
    vec3 way = position - (camera + vec3(0.0, 0.0, 0.25));
    float distance2 = dot(way, way);
    vec3 direction = way * inversesqrt(distance2);
    float beam = smoothstep(0.70, 0.97, dot(direction, camera_forward));
    float facing = abs(dot(normal, direction));
    light += vec3(1.0, 0.98, 0.92) * (searchlight * beam * (0.25 + 0.75 * facing) / max(distance2, 0.3));
  }
  return light;
}

// Light of the sun where no shadow falls; `through`: share that shines through a leaf.
vec3 sun_light(vec3 normal, float through) {
  float facing = dot(normal, to_sun);
  return sun * (max(facing, 0.0) + through * max(-facing, 0.0));
}

float clearness(vec3 position) { return exp(-haze * distance(position, camera)); }

vec4 encoded(vec3 radiance) {
  vec3 c = radiance * (exposure * 0.5);
  return sqrt(vec4(c, dot(c, vec3(0.25, 0.6, 0.15))));
}
)";

const char* const kShadow = R"(
uniform sampler2DShadow shadow_map;
float sunlit(vec3 at) {
  vec3 inside = step(vec3(0.0), at) * step(at, vec3(1.0));
  return mix(1.0, texture(shadow_map, at), inside.x * inside.y * inside.z);
}
)";

/// Objects are lit at their vertices: their quads are small and flat, and a crown of leaves covers each pixel
/// many times over. Only the shadow is looked up for each pixel, so that it is sharp.
const char* const kObjectVertex = R"(
uniform float time, wind;
out vec3 steady, sunny, veil, shadow_at;
out vec2 uv;
void main() {
  vec4 at = gl_Vertex;
  float phase = dot(gl_Vertex.xyz, vec3(1.7, 2.3, 1.1));
  at.xy += gl_Color.a * wind * 0.006 * vec2(sin(2.1 * time + phase), sin(1.7 * time + 1.3 * phase));
  vec3 normal = normalize(gl_Normal);
  float lies = smoothstep(0.35, 0.75, normal.z) * snow;
  vec3 albedo = gl_Color.rgb * gl_Color.rgb * (1.0 - 0.25 * wetness);
  albedo = mix(albedo, vec3(0.70, 0.72, 0.76), lies);
  float clear = clearness(at.xyz);
  steady = albedo * steady_light(normal, at.xyz) * clear;
  sunny = albedo * sun_light(normal, gl_Color.a > 0.0 ? 0.45 : 0.0) * clear;
  veil = horizon * (1.0 - clear);
  shadow_at = shadow_coordinates(at.xyz, normal);
  uv = gl_MultiTexCoord0.xy;
  gl_Position = gl_ModelViewProjectionMatrix * at;
}
)";

const char* const kObjectFragment = R"(
uniform sampler2D atlas;
in vec3 steady, sunny, veil, shadow_at;
in vec2 uv;
out vec4 colour;
void main() {
  vec4 texel = texture(atlas, uv);
  if (texel.a < 0.4) discard;
  float grey = texel.r * 1.75;
  vec3 light = steady;
  if (sun_visible > 0.0) light += sunny * sunlit(shadow_at);
  colour = encoded(light * (grey * grey) + veil);
}
)";

const char* const kGroundVertex = R"(
out vec3 position, normal;
void main() {
  position = gl_Vertex.xyz;
  normal = gl_Normal;
  gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
)";

const char* const kGroundFragment = R"(
uniform sampler2D ground;
uniform sampler2D path_distance;
uniform vec2 path_origin, litter_shift;
uniform float path_side, litter, dryness;
in vec3 position, normal;
out vec4 colour;
void main() {
  vec2 p = position.xy;
  vec4 fine = texture(ground, p * 0.42, -1.0);
  vec4 other = texture(ground, vec2(0.83 * p.x - 0.56 * p.y, 0.56 * p.x + 0.83 * p.y) * 0.19 + 0.37, -1.0);
  float broad = texture(ground, p * 0.021).a;
  float middle = texture(ground, p * 0.11 + 0.2).a;
  float away = texture(path_distance, (p - path_origin) / path_side).r * 5.0;
  float gravel = 1.0 - smoothstep(0.62, 0.84, away + 0.55 * (middle - 0.5) + 0.25 * (other.a - 0.5));

  float blades = 0.6 * fine.r + 0.4 * other.r;
  vec3 grass = mix(vec3(0.050, 0.095, 0.018), vec3(0.13, 0.17, 0.045), blades * blades * 1.6);
  grass = mix(grass, vec3(0.20, 0.17, 0.075) * (0.4 + blades), clamp(dryness + 0.6 * (broad - 0.55), 0.0, 1.0));
  grass = mix(grass, vec3(0.10, 0.075, 0.05), smoothstep(0.62, 0.75, middle) * 0.6) * (0.6 + 0.8 * broad);
  float stones = 0.55 * fine.g + 0.45 * other.g;
  vec3 surface = mix(grass, vec3(0.36, 0.32, 0.26) * (0.25 + 1.3 * stones * stones) * (0.6 + 0.8 * middle), gravel);

  if (litter > 0.0) {
    vec2 q = p + litter_shift;
    float leaf = texture(ground, q * 0.37, -1.0).b;
    float heap = texture(ground, q * 0.045).a;
    float cover = step(0.2, leaf) * step(1.0 - litter * (1.0 - 0.45 * gravel), heap * 0.7 + 0.3 * fine.a);
    vec3 brown = mix(vec3(0.09, 0.05, 0.02), vec3(0.42, 0.23, 0.05), leaf * leaf);
    surface = mix(surface, brown, cover);
  }
  surface *= 1.0 - 0.45 * wetness * (0.5 + 0.5 * gravel);
  if (snow > 0.0) {
    float bare = middle * 0.55 + 0.45 * fine.a + 0.18 * (blades - 0.5) + 0.12 * gravel;
    float lies = 1.0 - smoothstep(0.47 * snow + 0.12, 0.47 * snow + 0.24, bare);
    float drifts = 0.82 + 0.25 * (other.a - 0.5) + 0.5 * (middle - 0.5) + 0.10 * (fine.r - 0.5);
    surface = mix(surface, vec3(0.80, 0.82, 0.86) * drifts, lies);
  }
  vec3 n = normalize(normal);
  vec3 light = steady_light(n, position);
  if (sun_visible > 0.0) light += sun_light(n, 0.0) * sunlit(shadow_coordinates(position, n));
  colour = encoded(mix(horizon, surface * light, clearness(position)));
}
)";

const char* const kSkyVertex = R"(
uniform vec3 ray_middle, ray_right, ray_up;
out vec3 ray;
void main() {
  ray = ray_middle + gl_Vertex.x * ray_right + gl_Vertex.y * ray_up;
  gl_Position = vec4(gl_Vertex.xy, 1.0, 1.0);
}
)";

const char* const kSkyFragment = R"(
uniform sampler2D ground;
uniform float cloud_cover, cloud_drift;
in vec3 ray;
out vec4 colour;
void main() {
  vec3 direction = normalize(ray);
  float up = max(direction.z, 0.0);
  vec3 radiance = mix(horizon, sky, sqrt(up));
  float near_sun = max(dot(direction, to_sun), 0.0);
  if (sun_visible > 0.0) {
    radiance += sun * (0.10 * pow(near_sun, 12.0) + 0.5 * pow(near_sun, 180.0));
    if (near_sun > 0.99993) radiance += sun * 300.0;
  }
  vec2 cloud = direction.xy / (up + 0.12);
  float shape = texture(ground, cloud * 0.045 + vec2(cloud_drift, 0.3 * cloud_drift)).a;
  float density = smoothstep(0.72 - 0.5 * cloud_cover, 0.95 - 0.5 * cloud_cover, shape) * smoothstep(0.0, 0.2, up);
  vec3 white = horizon * 0.75 + sun * (0.25 + 0.3 * pow(near_sun, 4.0));
  vec3 grey = horizon * (0.75 + 0.5 * shape);
  radiance = mix(radiance, sun_visible > 0.0 ? white : grey, density * 0.9);
  colour = encoded(radiance);
}
)";

const char* const kShadowVertex = R"(
out vec2 uv;
void main() {
  uv = gl_MultiTexCoord0.xy;
  gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
}
)";

const char* const kShadowFragment = R"(
uniform sampler2D atlas;
in vec2 uv;
void main() {
  if (texture(atlas, uv).a < 0.4) discard;
}
)";

osg::ref_ptr<osg::Program> program(const std::string& vertex, const std::string& fragment) {
  osg::ref_ptr<osg::Program> result = new osg::Program;
  result->addShader(new osg::Shader(osg::Shader::VERTEX, kVersion + vertex));
  result->addShader(new osg::Shader(osg::Shader::FRAGMENT, kVersion + fragment));
  return result;
}

}  // namespace

osg::ref_ptr<osg::Program> objectProgram() {
  return program(std::string(kLight) + kObjectVertex, std::string(kLight) + kShadow + kObjectFragment);
}
osg::ref_ptr<osg::Program> groundProgram() {
  return program(kGroundVertex, std::string(kLight) + kShadow + kGroundFragment);
}
osg::ref_ptr<osg::Program> skyProgram() { return program(kSkyVertex, std::string(kLight) + kSkyFragment); }
osg::ref_ptr<osg::Program> shadowProgram() { return program(kShadowVertex, kShadowFragment); }

}  // namespace perennial::park
