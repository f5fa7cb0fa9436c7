// Makes materials that take their indirect light from transfer. Colours, textures, highlights and shadows of lights
// remain three's own.
import { MeshLambertMaterial } from 'three';
import { fitToDevice, fragmentDeclarations, fragmentLight, vertexBody, vertexDeclarations } from './shader_text.js';

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

/**
 * Returns a copy of a material that is lit by transfer. `kind` says how: `outputs` of its transfer, `glossy` by matrices,
 * `layered` as a smooth dielectric, the `table` that these two look up, `texels`,
 * `normalWeight`, whether `grids` around it are whole, whether there are `lamps` with cubes and `spheres` among them,
 * and whether it is `framed`, which gives it a tangent.
 */
export function litMaterial(source, kind, side, uniforms) {
  const material = kind.table ? source.clone() : lambertOf(source);
  material.side = side;
  material.shadowSide = null;
  material.onBeforeCompile = (shader, renderer) => {
    const fitted = fitToDevice(kind, renderer);
    material.lambentUniforms = shader.uniforms;
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = includeBefore(shader.vertexShader, 'common', vertexDeclarations(fitted));
    shader.vertexShader = includeAfter(shader.vertexShader, 'project_vertex', vertexBody(fitted));
    shader.fragmentShader = includeAfter(shader.fragmentShader, 'common', fragmentDeclarations(fitted));
    shader.fragmentShader = includeAfter(shader.fragmentShader, 'lights_fragment_maps', fragmentLight(fitted));
  };
  const { table, ...rest } = kind;
  const looked = table && [table.order, table.lobes, table.isotropic];
  material.customProgramCacheKey = () => `lambent ${JSON.stringify({ ...rest, looked })}`;
  return material;
}
