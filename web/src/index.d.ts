import type {
  Box3, Color, DirectionalLight, Euler, Group, Matrix3, Matrix4, Object3D, Quaternion, Scene, Texture, Vector3,
  WebGLRenderer,
} from 'three';
import type { GLTF, GLTFLoader, GLTFLoaderPlugin, GLTFParser } from 'three/addons/loaders/GLTFLoader.js';

export const MAX_ORDER: number;

/** Light from infinity as n² x RGB coefficients of spherical harmonics. */
export class LightVector {
  constructor(order?: number, rgb?: Float64Array);
  readonly order: number;
  readonly rgb: Float64Array;
  static constant(r: number, g: number, b: number, order?: number): LightVector;
  /** A disc of even radiance; the angular radius is in radians. */
  static disc(direction: Vector3, radius: number, color: { r: number; g: number; b: number }, order?: number): LightVector;
  /** Projects an equirectangular texture with pixels, as HDRLoader and EXRLoader make it. */
  static fromEquirect(texture: Texture, order?: number): LightVector;
  /** Renders what stands around a point of a scene and projects it. */
  static fromScene(renderer: WebGLRenderer, scene: Scene, position?: Vector3 | null, order?: number, size?: number): LightVector;
  clone(): LightVector;
  rotate(turn: Quaternion | Euler | Matrix3 | Matrix4): LightVector;
  /** Turns about +Y; positive radians take +Z towards +X. */
  rotateY(angle: number): LightVector;
  add(other: LightVector): LightVector;
  multiplyScalar(factor: number): LightVector;
  truncate(order: number): LightVector;
  radiance(direction: { x: number; y: number; z: number }): [number, number, number];
}

/** A baked scene in three; GLTFLoader puts it into gltf.userData.lambent. */
export class LambentScene {
  /** Light from infinity in the world, without key lights. */
  light: LightVector;
  /** Light of suns whose direct part comes by shadow maps; transfer brings what they bounce. */
  keyLight: LightVector | null;
  transfer: 'full' | 'shadowed' | 'unshadowed';
  /** Bands of the light that count, at most. */
  order: number;
  readonly disposed: boolean;
  /** Sets colour times strength of a lamp that was baked into a group: candela, or of a material the radiance. */
  setLamp(group: number, index: number, color: { r: number; g: number; b: number }): void;
  /**
   * Brings light to the groups in which something changed, with world matrices up to date, and returns whether there was
   * one. It happens by itself before a surface is drawn.
   */
  update(): boolean;
  dispose(): void;
}

/** The plugin for GLTFLoader.register(parser => new LambentPlugin(parser)). */
export class LambentPlugin implements GLTFLoaderPlugin {
  constructor(parser: GLTFParser, options?: { planes?: boolean });
  readonly name: string;
  afterRoot(gltf: GLTF): Promise<void>;
}

export interface ProgressiveOptions {
  onPlane?: (done: number, all: number) => void;
  signal?: AbortSignal;
}

/** Loads by HTTP ranges; gltf.userData.planesLoaded is a promise of the planes that follow. */
export function loadProgressively(loader: GLTFLoader, url: string, options?: ProgressiveOptions): Promise<GLTF>;

export interface Sun {
  direction: Vector3;
  /** Irradiance that falls straight on. */
  irradiance: Color;
}

/**
 * Divides an environment map into its suns and the rest; the radius of a sun is in radians. `environment` is the map
 * without suns, for scene.environment.
 */
export function splitKeyLights(
  texture: Texture,
  options?: { order?: number; most?: number; radius?: number },
): { rest: LightVector; key: LightVector; suns: Sun[]; environment: Texture };

/** Directional lights with shadow maps for suns. */
export class KeyLights extends Group {
  constructor(suns: Sun[], options?: { size?: number });
  readonly lights: DirectionalLight[];
  /** Fits shadow maps to a box in the world and lets meshes below `root` cast and receive shadows. */
  fit(box: Box3, root?: Object3D): this;
  dispose(): void;
}
