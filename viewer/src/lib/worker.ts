// SPDX-License-Identifier: Apache-2.0
// Draws in the background: one worker a material. To cancel is to end the worker.
import {
  type DrawOptions, type LoadedMaterial, type MaterialData, type PatternPhase, Runtime, type TextureMoments,
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
  | ({ kind: 'range' | 'phase' | 'moments' } & Torus)
  | { kind: 'patterns' };

/** What the requests that answer at once give. */
export interface Drawn {
  range: Float32Array;
  phase: PatternPhase;
  moments: TextureMoments;
  /** One table a subspace. */
  patterns: Float32Array[];
}

export type Reply =
  | { kind: 'loaded'; description: MaterialData }
  | { kind: 'texture'; subspace: number; texture: Float32Array }
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
    case 'phase':
      return loaded.drawPhase(request.rows, request.cols, request.seed);
    case 'moments':
      return loaded.moments(request.rows, request.cols, request.seed);
    case 'patterns':
      return loaded.description.subspaces.map((_, k) => loaded.pattern(k));
    case 'draw':
      loaded.draw(request.options, (subspace, texture) => {
        scope.postMessage({ kind: 'texture', subspace, texture }, [texture.buffer as ArrayBuffer]);
      });
      return undefined;
  }
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
