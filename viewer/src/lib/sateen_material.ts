// SPDX-License-Identifier: Apache-2.0
// A three.js material that shows a Sateen material in any scene, lit by its directional,
// ambient and hemisphere lights.
import {
  Color, DataTexture, ShaderMaterial, type ShaderMaterialParameters, type Texture, UniformsLib,
  UniformsUtils, Vector2, Vector3,
} from 'three';

import type { Material } from './material';
import { type MaterialData, START_SIDE } from './runtime';
import evaluation from './sateen.glsl?raw';
import {
  curveTexture, directionTextures, FieldTexture, LEVELS, LIST_COLS, planeTexture, surfaceTexture,
} from './textures';

/** What of a material is shown. */
export type ViewMode = 'combined' | 'smooth' | 'relief' | 'index';
const VIEW_MODES: ViewMode[] = ['combined', 'smooth', 'relief', 'index'];

export interface SateenMaterialOptions {
  /** Texels of the material along one unit of the mesh's u and v. */
  texelsPerUv?: [number, number];
  /** Side of the drawn tile in texels. */
  tile?: number;
  seed?: bigint;
  /** Show the one tile over and over, instead of blending shifted ones. */
  repeat?: boolean;
  onProgress?: (share: number) => void;
  signal?: AbortSignal;
}

const VERTEX = /* glsl */ `
varying vec2 vUv;
varying vec3 vNormal;
varying vec3 vViewPosition;
void main() {
    vUv = uv;
    vNormal = normalMatrix * normal;
    vec4 at = modelViewMatrix * vec4(position, 1.0);
    vViewPosition = -at.xyz;
    gl_Position = projectionMatrix * at;
}`;

const FRAGMENT = /* glsl */ `
#include <common>
#include <lights_pars_begin>
${evaluation}
void main() {
    gl_FragColor = vec4(sateen_radiance(), 1.0);
    #include <tonemapping_fragment>
    #include <colorspace_fragment>
}`;

/** A torus of the range map with about 512 texels a side, and its lowest and highest height. */
async function drawSurface(
  source: Material, seed: bigint, signal?: AbortSignal,
): Promise<{ texture: DataTexture; range: [number, number] }> {
  const tile = source.description.surface;
  if (!tile) return { texture: surfaceTexture(new Float32Array(1), 1, 1), range: [0, 0] };
  // Whole tiles, so that nothing is strained.
  const side = (length: number): number => length * Math.max(1, Math.round(512 / length));
  const [rows, cols] = [side(tile.rows), side(tile.cols)];
  const heights = await source.drawRange(rows, cols, seed, signal);
  let range: [number, number] = [Infinity, -Infinity];
  for (const z of heights) range = [Math.min(range[0], z), Math.max(range[1], z)];
  return { texture: surfaceTexture(heights, rows, cols), range };
}

/** Colours that tell subspaces apart, by the golden angle. */
export function subspaceColours(count: number): Color[] {
  return Array.from({ length: count }, (_, k) =>
    new Color().setHSL((k * 0.381966) % 1, 0.55, 0.42 + 0.16 * (k % 3)));
}

export class SateenMaterial extends ShaderMaterial {
  readonly isSateenMaterial = true;
  private readonly owned: Texture[] = [];

  private constructor(readonly description: MaterialData, parameters: ShaderMaterialParameters) {
    super(parameters);
  }

  /** Draws the fields of every subspace in the background, then makes the material. */
  static async create(source: Material, options: SateenMaterialOptions = {}): Promise<SateenMaterial> {
    const { tile = 256, seed = 0n, texelsPerUv = [1024, 1024], repeat = false } = options;
    const { description } = source;
    const subspaces = description.subspaces.length;
    const fields = new FieldTexture(tile, description.bands, subspaces);
    const { onProgress, signal } = options;
    // What is more than fields is shown as it is drawn, one tile over and over.
    const fieldsOnly = !description.structured;
    await source.draw({
      rows: tile, cols: tile, seed, fieldsOnly, onProgress, signal,
      onTexture: (k, texture) => (fieldsOnly
        ? fields.set(k, texture, description.subspaces[k]!)
        : fields.setColour(k, texture)),
    });
    const surface = await drawSurface(source, seed, signal);

    const measured = description.views.length > 0;
    const directions = directionTextures(description, fields.mean);
    const curves = curveTexture(description.subspaces, fields.variance);
    const planes = planeTexture(description.subspaces, fields.variance);
    const material = new SateenMaterial(description, {
      lights: true,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      defines: {
        SUBSPACES: subspaces,
        LEVELS,
        LIST_COLS,
        START_SIDE,
        VIEWS: description.views.length,
        ANISOTROPY: '8.0',
        LOWEST_LIGHT: directions.lowestLight.toFixed(6),
        RELIEF_STEPS: 24,
        SHADOW_STEPS: 12,
        ...(measured && { MEASURED: 1 }),
        ...(measured && description.cosineIncluded && { COSINE_INCLUDED: 1 }),
        ...((repeat || !fieldsOnly) && { REPEAT: 1 }),
        ...(!fieldsOnly && { COLOURS: 1 }),
        ...(surface.range[1] > surface.range[0] && { SURFACE: 1 }),
      },
      uniforms: UniformsUtils.merge([UniformsLib.lights, {
        texelsPerUv: { value: new Vector2(...texelsPerUv) },
        fieldSize: { value: new Vector2(tile, tile) },
        surfaceSize: { value: new Vector2(surface.texture.image.width, surface.texture.image.height) },
        heightRange: { value: new Vector2(...surface.range) },
        relief: { value: 1 },
        tint: { value: new Color(1, 1, 1) },
        exposure: { value: 1 },
        viewMode: { value: 0 },
        palette: { value: subspaceColours(subspaces).map((c) => new Vector3(c.r, c.g, c.b)) },
      }]),
    });
    // Not merged: that would copy the textures.
    Object.assign(material.uniforms, {
      fields: { value: fields.texture },
      curves: { value: curves },
      planes: { value: planes },
      viewCells: { value: directions.viewCells },
      lightCells: { value: directions.lightCells },
      pairs: { value: directions.pairs },
      surface: { value: surface.texture },
    });
    material.owned.push(fields.texture, curves, planes, directions.viewCells, directions.lightCells,
      directions.pairs, surface.texture);
    return material;
  }

  get texelsPerUv(): Vector2 {
    return this.uniforms.texelsPerUv!.value as Vector2;
  }
  get tint(): Color {
    return this.uniforms.tint!.value as Color;
  }
  set exposure(value: number) {
    this.uniforms.exposure!.value = value;
  }
  /** Scale of the heights; 1 is as measured. */
  set relief(value: number) {
    this.uniforms.relief!.value = value;
  }
  set viewMode(mode: ViewMode) {
    this.uniforms.viewMode!.value = VIEW_MODES.indexOf(mode);
  }

  /** Whether there is relief to show. */
  get hasSurface(): boolean {
    return 'SURFACE' in this.defines!;
  }

  override dispose(): void {
    for (const texture of this.owned) texture.dispose();
    super.dispose();
  }
}
