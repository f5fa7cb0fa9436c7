// The depth of what stands in three's scene, for volumes: rays end at it. It is drawn before the first volume of a
// picture, with all that is opaque.
import { DepthTexture, FloatType, FrontSide, MeshBasicMaterial, Vector4, WebGLRenderTarget } from 'three';

const isOpaque = ({ isMesh, material }) => isMesh && ![material].flat().some((m) => m.transparent);
// What a material cuts away, and backs, are its own affair.
const isPlain = (m) => m.side === FrontSide && m.alphaTest === 0 && !m.alphaHash && !m.displacementMap;

export class SceneDepth {
  constructor() {
    this.plain = new MeshBasicMaterial({ colorWrite: false });
    this.viewport = new Vector4();
  }

  /** Returns the depth for a camera, drawn once a picture, and writes where the viewport lies to `corner`. */
  draw(renderer, passes, root, camera, corner) {
    const { viewport } = this;
    renderer.getCurrentViewport(viewport);
    corner.set(viewport.x, viewport.y);
    if (this.frame !== renderer.info.render.frame || this.camera !== camera) {
      this.makeRoom(viewport.z, viewport.w);
      this.drawAnew(renderer, passes, root, camera);
      Object.assign(this, { frame: renderer.info.render.frame, camera });
    }
    return this.target.depthTexture;
  }

  drawAnew(renderer, passes, root, camera) {
    const hidden = [], own = new Set();
    root.traverseVisible((object) => {
      if (!object.isMesh && !object.isLine && !object.isPoints && !object.isSprite) return;
      if (!isOpaque(object)) hidden.push([object, object.layers.mask]);
      else for (const m of [object.material].flat()) if (!isPlain(m) && m.allowOverride) own.add(m);
    });
    const { background, overrideMaterial, matrixWorldAutoUpdate } = root;
    for (const [object] of hidden) object.layers.mask = 0;
    for (const m of own) m.allowOverride = false;
    Object.assign(root, { background: null, overrideMaterial: this.plain, matrixWorldAutoUpdate: false });
    try {
      passes.during(renderer, () => {
        renderer.setRenderTarget(this.target);
        renderer.clear();
        renderer.render(root, camera);
      });
    } finally {
      Object.assign(root, { background, overrideMaterial, matrixWorldAutoUpdate });
      for (const [object, mask] of hidden) object.layers.mask = mask;
      for (const m of own) m.allowOverride = true;
    }
  }

  makeRoom(width, height) {
    if (this.target?.width === width && this.target.height === height) return;
    this.target?.dispose();
    this.target?.depthTexture.dispose();
    this.target = new WebGLRenderTarget(width, height, { depthTexture: new DepthTexture(width, height, FloatType) });
  }

  dispose() {
    this.target?.dispose();
    this.target?.depthTexture.dispose();
    this.plain.dispose();
  }
}
