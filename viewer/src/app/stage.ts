// SPDX-License-Identifier: Apache-2.0
// The scene: one object, one lamp, surroundings; drawn only when something has changed.
import {
  AmbientLight, Box3, BufferGeometry, CanvasTexture, DirectionalLight, DoubleSide, Group, HemisphereLight, Mesh,
  MeshBasicMaterial, NeutralToneMapping, NoToneMapping, PerspectiveCamera, PlaneGeometry, Scene, ShaderMaterial,
  Spherical, SRGBColorSpace, Vector3, WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/addons/controls/OrbitControls.js';

import type { SateenMaterial, ViewMode } from '../lib/sateen_material';
import { makeShape, type ShapeName, uvLengths } from './shapes';

export interface Surroundings {
  label: string;
  lamp: number;
  lampColour: number;
  sky: number;
  ground: number;
  around: number;
}

export const SURROUNDINGS: Record<string, Surroundings> = {
  studio: { label: 'Studio', lamp: 2.9, lampColour: 0xfff6ea, sky: 0xdfe8f5, ground: 0x8a7f74, around: 0.55 },
  daylight: { label: 'Daylight', lamp: 3.0, lampColour: 0xfff1d6, sky: 0xa9c8f0, ground: 0x6d6a55, around: 1.0 },
  overcast: { label: 'Overcast', lamp: 0.9, lampColour: 0xffffff, sky: 0xe8edf2, ground: 0x8e8e88, around: 2.1 },
  evening: { label: 'Evening', lamp: 3.2, lampColour: 0xffc58a, sky: 0x6d7fb0, ground: 0x4a3a3a, around: 0.6 },
  lamp: { label: 'Lamp alone', lamp: Math.PI, lampColour: 0xffffff, sky: 0, ground: 0, around: 0 },
};

/** The second material, and where the picture is divided: 0 … 1 from the left. */
export interface Split {
  material: SateenMaterial;
  at: number;
}

export class Stage {
  readonly renderer: WebGLRenderer;
  readonly camera = new PerspectiveCamera(30, 1, 0.05, 60);
  readonly controls: OrbitControls;
  private readonly scene = new Scene();
  private readonly lamp = new DirectionalLight();
  private readonly around = new HemisphereLight();
  private readonly holder = new Group();
  private readonly floor: Mesh;
  private readonly waiting = new MeshBasicMaterial({ visible: false });
  private background: CanvasTexture | undefined;
  private queued = false;
  private reference = false;
  private shape: ShapeName | 'own' = 'sphere';
  private texelsPerLength = 512;
  material: SateenMaterial | undefined;
  split: Split | undefined;
  /** Called after each picture. */
  onFrame: (milliseconds: number) => void = () => {};

  constructor(readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.toneMapping = NeutralToneMapping;
    this.scene.add(this.holder, this.lamp, this.lamp.target, this.around, new AmbientLight(0xffffff, 0));
    this.floor = new Mesh(new PlaneGeometry(1, 1), shadowMaterial());
    this.floor.rotation.x = -Math.PI / 2;
    this.floor.renderOrder = -1;
    this.scene.add(this.floor);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.enablePan = false;
    this.controls.minDistance = 1.2;
    this.controls.maxDistance = 14;
    this.controls.mouseButtons = { LEFT: 0, MIDDLE: 1, RIGHT: -1 as never };
    this.controls.addEventListener('change', () => this.draw());
    this.setShape('sphere');
    this.resetView();
    this.setLamp({ theta: 0.9, phi: 2.2 });
    this.setSurroundings('studio');
    new ResizeObserver(() => this.resize()).observe(canvas);
  }

  /** What fetches may take along slanted pixels: renderers in software are slow at it. */
  get anisotropy(): number {
    const gl = this.renderer.getContext();
    const names = gl.getExtension('WEBGL_debug_renderer_info');
    const name = String(names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : '');
    return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name) ? 1 : 8;
  }

  resetView(): void {
    const flat = this.shape === 'plane';
    this.camera.position.set(0, flat ? 0 : 0.55, 1).normalize().multiplyScalar(this.distance());
    this.controls.target.set(0, 0, 0);
    this.controls.update();
    this.draw();
  }

  /** From where the object fills the smaller side of the picture, which spans 30 degrees. */
  private distance(): number {
    return { sphere: 4.9, plane: 6.0, cloth: 6.2, knot: 5.4, own: 5.4 }[this.shape];
  }

  /** Direction to the lamp: theta from the viewer, phi counter-clockwise from the right. */
  setLamp({ theta, phi }: { theta: number; phi: number }): void {
    this.lamp.position.set(
      Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta)).multiplyScalar(5);
    this.draw();
  }

  setSurroundings(name: string): void {
    const s = SURROUNDINGS[name]!;
    this.lamp.intensity = s.lamp;
    this.lamp.color.set(s.lampColour);
    this.around.color.set(s.sky);
    this.around.groundColor.set(s.ground);
    this.around.intensity = s.around;
    this.draw();
  }

  setShape(name: ShapeName): void {
    this.shape = name;
    this.show(new Mesh(makeShape(name), this.waiting));
  }

  /** An object of the user's, scaled to fit. */
  setObject(object: Group | Mesh): void {
    this.shape = 'own';
    const box = new Box3().setFromObject(object);
    const size = box.getSize(new Vector3());
    const scale = 2.2 / Math.max(size.x, size.y, size.z, 1e-6);
    object.position.sub(box.getCenter(new Vector3())).multiplyScalar(scale);
    object.scale.multiplyScalar(scale);
    this.show(object);
  }

  private show(object: Group | Mesh): void {
    for (const child of this.holder.children)
      child.traverse((o) => o instanceof Mesh && (o.geometry as BufferGeometry).dispose());
    this.holder.clear();
    this.holder.add(object);
    const box = new Box3().setFromObject(object);
    this.floor.visible = this.shape !== 'plane';
    this.floor.position.y = box.min.y - 0.01;
    this.floor.scale.setScalar(1.5 * Math.max(box.max.x - box.min.x, box.max.z - box.min.z));
    this.resetView();
  }

  /** How many texels of the material lie on the length of 1. */
  setScale(texelsPerLength: number): void {
    this.texelsPerLength = texelsPerLength;
    this.draw();
  }

  /** A soft gradient. */
  setBackground(top: string, bottom: string): void {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [16, 256];
    const context = canvas.getContext('2d')!;
    const gradient = context.createLinearGradient(0, 0, 0, 256);
    gradient.addColorStop(0, top);
    gradient.addColorStop(1, bottom);
    context.fillStyle = gradient;
    context.fillRect(0, 0, 16, 256);
    this.background?.dispose();
    this.background = new CanvasTexture(canvas);
    this.background.colorSpace = SRGBColorSpace;
    this.scene.background = this.background;
    this.draw();
  }

  setViewMode(mode: ViewMode): void {
    this.renderer.toneMapping = mode === 'index' ? NoToneMapping : NeutralToneMapping;
    for (const m of [this.material, this.split?.material]) if (m) m.viewMode = mode;
    this.draw();
  }

  /**
   * The scene of `sateen render --mesh plane --exposure 1` under one light: the same camera, no tone mapping.
   * Directions are [theta, phi] in radians in the frame of the plane.
   */
  showReference(view: [number, number], light: [number, number], repeats: number, texels: number): void {
    const towards = ([theta, phi]: [number, number]): Vector3 =>
      new Vector3(Math.sin(theta) * Math.cos(phi), Math.sin(theta) * Math.sin(phi), Math.cos(theta));
    const FIELD_OF_VIEW = 28;
    const ROOM = 1.06;
    this.renderer.toneMapping = NoToneMapping;
    this.shape = 'plane';
    this.show(new Mesh(new PlaneGeometry(2, 2), this.waiting));
    this.reference = true;
    this.setScale((repeats * texels) / 2);
    this.camera.fov = FIELD_OF_VIEW;
    // Seen from the pole, +y is up.
    const [theta, phi] = [view[0], view[0] === 0 ? -Math.PI / 2 : view[1]];
    this.camera.up.set(-Math.cos(theta) * Math.cos(phi), -Math.cos(theta) * Math.sin(phi), Math.sin(theta));
    this.camera.position.copy(towards([theta, phi])).multiplyScalar(ROOM / Math.sin((FIELD_OF_VIEW * Math.PI) / 360));
    this.camera.lookAt(0, 0, 0);
    this.camera.updateProjectionMatrix();
    this.setSurroundings('lamp');
    this.lamp.position.copy(towards(light)).multiplyScalar(5);
    this.drawNow();
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    if (!this.reference) {
      const half = Math.tan(Math.PI / 12) / Math.min(1, this.camera.aspect);
      this.camera.fov = (Math.atan(half) * 360) / Math.PI;
    }
    this.camera.updateProjectionMatrix();
    this.drawNow();
  }

  draw(): void {
    if (this.queued) return;
    this.queued = true;
    requestAnimationFrame(() => {
      this.queued = false;
      this.drawNow();
    });
  }

  drawNow(): void {
    const start = performance.now();
    const { width, height } = this.canvas;
    const ratio = this.renderer.getPixelRatio();
    const split = this.split;
    this.renderer.setScissorTest(split !== undefined);
    const across = split ? Math.round(split.at * width) : width;
    this.drawWith(this.material, 0, across / ratio, height / ratio);
    if (split) this.drawWith(split.material, across / ratio, (width - across) / ratio, height / ratio);
    this.onFrame(performance.now() - start);
  }

  private drawWith(material: SateenMaterial | undefined, left: number, width: number, height: number): void {
    this.renderer.setScissor(left, 0, width, height);
    this.holder.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      object.material = material ?? this.waiting;
      if (!material) return;
      // One material serves meshes of several sizes: its uniforms are set before each is drawn.
      const lengths = ((object.userData.uvLengths as [number, number] | undefined) ??
        (object.userData.uvLengths = uvLengths(object.geometry as BufferGeometry)));
      const scale = object.getWorldScale(new Vector3()).x * this.texelsPerLength;
      object.onBeforeRender = () => {
        material.texelsPerUv.set(lengths[0] * scale, lengths[1] * scale);
        material.uniformsNeedUpdate = true;
      };
    });
    if (material) material.side = DoubleSide;
    this.renderer.render(this.scene, this.camera);
  }

  /** Compiles a material for this scene while the page goes on. */
  async prepare(material: ShaderMaterial): Promise<void> {
    material.side = DoubleSide;
    const mesh = new Mesh(new PlaneGeometry(), material);
    if (this.renderer.extensions.has('KHR_parallel_shader_compile'))
      await this.renderer.compileAsync(mesh, this.camera, this.scene);
    // A renderer in software compiles again at the first draw with it: that of one pixel in the corner.
    this.scene.add(mesh);
    this.renderer.setScissorTest(true);
    this.renderer.setScissor(0, 0, 1, 1);
    this.renderer.render(this.scene, this.camera);
    this.renderer.setScissorTest(false);
    this.scene.remove(mesh);
    mesh.geometry.dispose();
  }

  /** The present picture as a PNG. */
  async screenshot(): Promise<Blob> {
    this.drawNow();
    return new Promise((resolve, reject) =>
      this.canvas.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('no picture'))), 'image/png'));
  }

  /** Turns the view by angles in radians, as a drag does. */
  turn(azimuth: number, elevation: number): void {
    const s = new Spherical().setFromVector3(this.camera.position);
    s.theta += azimuth;
    s.phi = Math.min(Math.PI - 0.05, Math.max(0.05, s.phi - elevation));
    this.camera.position.setFromSpherical(s);
    this.controls.update();
    this.draw();
  }

  zoom(factor: number): void {
    const distance = Math.min(14, Math.max(1.2, this.camera.position.length() * factor));
    this.camera.position.setLength(distance);
    this.controls.update();
    this.draw();
  }
}

/** A soft dark patch on the ground, where an object would keep the light of the sky away. */
function shadowMaterial(): ShaderMaterial {
  return new ShaderMaterial({
    transparent: true,
    depthWrite: false,
    vertexShader: `varying vec2 at;
void main() { at = 2.0 * uv - 1.0; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: `varying vec2 at;
void main() { float d = length(at); gl_FragColor = vec4(0.0, 0.0, 0.0, 0.38 * exp(-7.0 * d * d) * (1.0 - smoothstep(0.75, 1.0, d))); }`,
  });
}
