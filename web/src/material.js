// Makes materials that take their indirect light from transfer. Colours, textures, highlights and shadows of lights
// remain three's own.
import { MeshLambertMaterial } from 'three';
import { VERTEX_DECLARATIONS, VERTEX_BODY, FRAGMENT_DECLARATIONS, FRAGMENT_LIGHT } from './shader_text.js';

const SHARED = [
  'name', 'map', 'emissiveMap', 'emissiveIntensity', 'normalMap', 'normalMapType', 'alphaTest', 'transparent',
  'opacity', 'depthWrite', 'side', 'vertexColors', 'flatShading', 'fog', 'toneMapped',
];

/** Tells whether a material has no specular light: no metal, and rough everywhere or of specular strength 0. */
export function isMatte(material, isDefault) {
  if (isDefault) return true; // primitives without a material count as matte
  if (!material.isMeshStandardMaterial || material.metalness !== 0) return false;
  return (material.roughness === 1 && !material.roughnessMap) || material.specularIntensity === 0;
}

// The diffuse materials of a bundle are Lambert's, whereas three's standard material adds a highlight to all.
function lambertOf(material) {
  const out = new MeshLambertMaterial();
  for (const key of SHARED) out[key] = material[key];
  out.color.copy(material.color);
  out.emissive.copy(material.emissive);
  out.normalScale.copy(material.normalScale);
  out.userData = { ...material.userData };
  return out;
}

function includeBefore(text, chunk, added) {
  const include = `#include <${chunk}>`;
  if (!text.includes(include)) throw new Error(`three's shader has no ${include}`);
  return text.replace(include, `${added}\n${include}`);
}

function includeAfter(text, chunk, added) {
  return includeBefore(text, chunk, '').replace(`#include <${chunk}>`, `#include <${chunk}>\n${added}`);
}

/** Returns a copy of a material that is lit by transfer. `uniforms` holds groupFromWorld and, with texels, texels. */
export function litMaterial(source, { matte, mapped, texels, normalWeight, side, uniforms }) {
  const material = matte ? lambertOf(source) : source.clone();
  material.side = side;
  material.shadowSide = null;
  material.defines = { ...material.defines };
  if (mapped) material.defines.LAMBENT_MAPPED = '';
  if (texels) material.defines.LAMBENT_TEXELS = '';
  if (normalWeight) material.defines.LAMBENT_NORMAL_WEIGHT = '';
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = includeBefore(shader.vertexShader, 'common', VERTEX_DECLARATIONS);
    shader.vertexShader = includeAfter(shader.vertexShader, 'project_vertex', VERTEX_BODY);
    shader.fragmentShader = includeAfter(shader.fragmentShader, 'common', FRAGMENT_DECLARATIONS);
    shader.fragmentShader = includeAfter(shader.fragmentShader, 'lights_fragment_maps', FRAGMENT_LIGHT);
  };
  material.customProgramCacheKey = () => 'lambent';
  return material;
}
