// SPDX-License-Identifier: Apache-2.0
// A three.js material that shows a Sateen material in any scene, lit by its directional,
// ambient and hemisphere lights.
import {
  Color, DataTexture, ShaderMaterial, type ShaderMaterialParameters, type Texture, UniformsLib,
  UniformsUtils, Vector2, Vector3,
} from 'three';

import type { Material } from './material';
import type { Description } from './runtime';
import evaluation from './sateen.glsl?raw';
import {
  curveTexture, directionTextures, FieldTexture, LEVELS, LIST_COLS, planeTexture,
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

/** Colours that tell subspaces apart, by the golden angle. */
export function subspaceColours(count: number): Color[] {
  return Array.from({ length: count }, (_, k) =>
    new Color().setHSL((k * 0.381966) % 1, 0.55, 0.42 + 0.16 * (k % 3)));
}

export class SateenMaterial extends ShaderMaterial {
  readonly isSateenMaterial = true;
  private readonly owned: Texture[] = [];

  private constructor(readonly description: Description, parameters: ShaderMaterialParameters) {
    super(parameters);
  }

  /** Draws the fields of every subspace in the background, then makes the material. */
  static async create(source: Material, options: SateenMaterialOptions = {}): Promise<SateenMaterial> {
    const { tile = 256, seed = 0n, texelsPerUv = [1024, 1024], repeat = false } = options;
    const { description } = source;
    const subspaces = description.subspaces.length;
    const fields = new FieldTexture(tile, description.bands, subspaces);
    await source.draw({
      rows: tile, cols: tile, seed, fieldsOnly: true,
      onTexture: (k, texture) => fields.set(k, texture),
      onProgress: options.onProgress,
      signal: options.signal,
    });

    const measured = description.views.length > 0;
    const directions = directionTextures(description);
    const curves = curveTexture(description.subspaces, fields.variance);
    const planes = planeTexture(description.subspaces, fields.variance);
    const flat = new DataTexture(new Float32Array(4), 1, 1);
    const material = new SateenMaterial(description, {
      lights: true,
      vertexShader: VERTEX,
      fragmentShader: FRAGMENT,
      defines: {
        SUBSPACES: subspaces,
        LEVELS,
        PAIR_COLS: LIST_COLS,
        VIEWS: directions.views,
        ANISOTROPY: '8.0',
        LOWEST_LIGHT: directions.lowestLight.toFixed(6),
        RELIEF_STEPS: 24,
        SHADOW_STEPS: 12,
        ...(measured && { MEASURED: 1 }),
        ...(measured && description.cosineIncluded && { COSINE_INCLUDED: 1 }),
        ...(repeat && { REPEAT: 1 }),
      },
      uniforms: UniformsUtils.merge([UniformsLib.lights, {
        texelsPerUv: { value: new Vector2(...texelsPerUv) },
        fieldSize: { value: new Vector2(tile, tile) },
        surfaceSize: { value: new Vector2(1, 1) },
        heightRange: { value: new Vector2() },
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
      viewMap: { value: directions.viewMap },
      lightMap: { value: directions.lightMap },
      directions: { value: directions.directions },
      pairs: { value: directions.pairs },
      surface: { value: flat },
    });
    material.owned.push(fields.texture, curves, planes, directions.viewMap, directions.lightMap,
      directions.directions, directions.pairs, flat);
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
