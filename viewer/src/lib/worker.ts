// SPDX-License-Identifier: Apache-2.0
// Draws in the background: one worker a material. To cancel is to end the worker.
import { type Basis, makeBasis } from './basis';
import {
  type DrawOptions, type LoadedMaterial, type MaterialData, type PatternPhase, Runtime,
} from './runtime';

/** A torus to be drawn on. */
export interface Torus {
  rows: number;
  cols: number;
  seed: bigint;
}

export type Request =
  | { kind: 'load'; module: WebAssembly.Module; payload: Uint8Array }
  | { kind: 'draw'; options: DrawOptions }
  | ({ kind: 'range' | 'basis' } & Torus);

/** What the requests that answer at once give. */
export interface Drawn {
  range: Float32Array;
  /** With the phase of the pattern on the same torus. */
  basis: { basis: Basis; phase: PatternPhase | undefined };
}

export type Reply =
  | { kind: 'loaded'; description: MaterialData }
  | { kind: 'texture'; subspace: number; texture: Float32Array }
  | { kind: 'progress'; share: number }
  | { kind: 'drawn'; result?: Drawn[keyof Drawn] }
  | { kind: 'failed'; message: string };

const scope = self as unknown as {
  onmessage: ((event: MessageEvent<Request>) => void) | null;
  postMessage(reply: Reply, transfer?: Transferable[]): void;
};

let material: LoadedMaterial | undefined;

function drawn(request: Exclude<Request, { kind: 'load' }>, loaded: LoadedMaterial): Drawn[keyof Drawn] | undefined {
  switch (request.kind) {
    case 'range':
      return loaded.drawRange(request.rows, request.cols, request.seed);
    case 'basis':
      return drawBasis(request, loaded);
    case 'draw':
      loaded.draw(request.options, (subspace, texture) => {
        scope.postMessage({ kind: 'texture', subspace, texture }, [texture.buffer as ArrayBuffer]);
      });
      return undefined;
  }
}

function drawBasis(torus: Torus, loaded: LoadedMaterial): Drawn['basis'] {
  const { rows, cols, seed } = torus;
  const { subspaces, pattern, bands } = loaded.description;
  const textures: Float32Array[] = [];
  loaded.draw({ rows, cols, seed }, (k, texture) => {
    textures[k] = texture;
    scope.postMessage({ kind: 'progress', share: (0.8 * (k + 1)) / subspaces.length });
  });
  const phase = pattern ? loaded.drawPhase(rows, cols, seed) : undefined;
  return { basis: makeBasis(textures, bands, torus, phase && { phase, cell: pattern! }), phase };
}

async function answer(request: Request): Promise<void> {
  if (request.kind === 'load') {
    material = (await Runtime.create(request.module)).load(request.payload);
    scope.postMessage({ kind: 'loaded', description: material.description });
  } else {
    scope.postMessage({ kind: 'drawn', result: drawn(request, material!) });
  }
}

scope.onmessage = (event) => {
  answer(event.data).catch((error: unknown) => {
    const message = error instanceof Error ? error.message : String(error);
    scope.postMessage({ kind: 'failed', message });
  });
};
