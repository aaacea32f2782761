// The renderer's light (render/shaders.h) for three.js: all of it linear, encoded as sRGB at the end.
import { DoubleSide, FrontSide, ShaderMaterial, Vector3, Vector4 } from 'three';

const kOccluders = 24;
const kLamps = 8;  // of which `lamps` are there

const kCode = `
vec3 code(vec3 x) {
  x = clamp(x, 0.0, 1.0);
  return mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, vec3(lessThan(x, vec3(0.0031308))));
}`;

/** The same of one number, for colours whose light is known beforehand. */
export function coded(x) {
  const one = Math.min(Math.max(x, 0), 1);
  return one < 0.0031308 ? 12.92 * one : 1.055 * one ** (1 / 2.4) - 0.055;
}

// Colours of surfaces that are not lit here are coded already: their tint is one of the code.
const kVertex = `
attribute vec3 colour;
varying vec3 p_W;
varying vec3 n_W;
varying vec3 c;
uniform vec3 tint;
void main() {
  vec4 p = modelMatrix * vec4(position, 1.0);
  p_W = p.xyz;
  n_W = mat3(modelMatrix) * normal;
#ifdef LIT
  c = colour;
#else
  c = colour * tint;
#endif
  gl_Position = projectionMatrix * viewMatrix * p;
}`;

const kCommon = `
varying vec3 p_W;
varying vec3 n_W;
varying vec3 c;
uniform float opacity;
`;

// Lamps (Lambert, Blinn), light from above and below, and their reflection.
const kLit = `${kCommon}${kCode}
uniform vec3 tint;
uniform vec3 sky;
uniform vec3 ground;
uniform int lamps;
uniform vec3 lampAt[${kLamps}];
uniform vec3 lampPower[${kLamps}];
uniform float gloss;
void main() {
  vec3 n = normalize(n_W);
  vec3 v = normalize(cameraPosition - p_W);
  vec3 diffuse = mix(ground, sky, 0.5 + 0.5 * n.z);
  vec3 shine = vec3(0.0);
  for (int i = 0; i < ${kLamps}; ++i) {
    if (i >= lamps) break;
    vec3 l = lampAt[i] - p_W;
    float d2 = dot(l, l);
    l *= inversesqrt(d2);
    vec3 power = lampPower[i] / d2;
    diffuse += power * max(dot(n, l), 0.0);
    float s = max(dot(n, normalize(l + v)), 0.0);
    s *= s; s *= s; s *= s; s *= s; s *= s; s *= s;  // to the 64th
    shine += power * s;
  }
  float graze = 1.0 - max(dot(n, v), 0.0);
  float fresnel = 0.04 + 0.5 * graze * graze * graze * graze * graze;
  vec3 r = reflect(-v, n);
  shine += fresnel * mix(ground, sky, smoothstep(-0.2, 0.2, r.z));
  gl_FragColor = vec4(code((c * diffuse + gloss * shine) * tint), opacity);
}`;

const kBaked = `${kCommon}
void main() { gl_FragColor = vec4(c, opacity); }`;

// Floors darken beneath what stands on them: the share of the sky that a ball keeps away.
const kFloor = `${kCommon}
uniform vec4 occluders[${kOccluders}];
uniform vec4 shaded;  // least x, y, greatest x, y: elsewhere nothing keeps light away
void main() {
  float left = 1.0;
  if (p_W.x > shaded.x && p_W.y > shaded.y && p_W.x < shaded.z && p_W.y < shaded.w) {
    for (int i = 0; i < ${kOccluders}; ++i) {
      vec4 ball = occluders[i];
      if (ball.w <= 0.0) break;
      vec3 d = ball.xyz - p_W;
      float d2 = max(dot(d, d), 1e-6);
      float taken = ball.w * ball.w * max(d.z, 0.0) * inversesqrt(d2) / d2;
      left *= 1.0 - clamp(taken - 0.01, 0.0, 0.95);
    }
    left = pow(left, 1.0 / 2.2);  // what the code of a darker light is less
  }
  gl_FragColor = vec4(c * left, opacity);
}`;

/** What every material shares: change it, and all of them see it. */
export function makeLight(light) {
  const lamps = [...light.lamps];
  while (lamps.length < kLamps) lamps.push({ p: [0, 0, 1e3], power: [0, 0, 0] });
  return {
    sky: { value: new Vector3(...light.sky) },
    ground: { value: new Vector3(...light.ground) },
    lamps: { value: Math.min(light.lamps.length, kLamps) },
    lampAt: { value: lamps.slice(0, kLamps).map((lamp) => new Vector3(...lamp.p)) },
    lampPower: { value: lamps.slice(0, kLamps).map((lamp) => new Vector3(...lamp.power)) },
    occluders: { value: Array.from({ length: kOccluders }, () => new Vector4(0, 0, -9, 0)) },
    shaded: { value: new Vector4() },
  };
}

export function materialOf(mesh, light, { opacity = 1, tint = [1, 1, 1], doubleSided = false } = {}) {
  const fragment = { lit: kLit, baked: kBaked, floor: kFloor }[mesh.surface];
  return new ShaderMaterial({
    vertexShader: kVertex,
    fragmentShader: fragment,
    defines: mesh.surface === 'lit' ? { LIT: '' } : {},
    transparent: opacity < 1,
    side: doubleSided ? DoubleSide : FrontSide,
    uniforms: {
      ...light,
      gloss: { value: mesh.gloss },
      opacity: { value: opacity },
      tint: { value: new Vector3(...tint) },
    },
  });
}
