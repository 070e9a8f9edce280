// SPDX-License-Identifier: Apache-2.0
// Draws in the background: one worker a material. To cancel is to end the worker.
import { type DrawOptions, type LoadedMaterial, type MaterialData, Runtime } from './runtime';

export type Request =
  | { kind: 'load'; module: WebAssembly.Module; payload: Uint8Array }
  | { kind: 'draw'; options: DrawOptions }
  | { kind: 'range'; rows: number; cols: number; seed: bigint };

export type Reply =
  | { kind: 'loaded'; description: MaterialData }
  | { kind: 'texture'; subspace: number; texture: Float32Array }
  | { kind: 'drawn' }
  | { kind: 'failed'; message: string };

const scope = self as unknown as {
  onmessage: ((event: MessageEvent<Request>) => void) | null;
  postMessage(reply: Reply, transfer?: Transferable[]): void;
};

let material: LoadedMaterial | undefined;

async function answer(request: Request): Promise<void> {
  if (request.kind === 'load') {
    material = (await Runtime.create(request.module)).load(request.payload);
    scope.postMessage({ kind: 'loaded', description: material.description });
  } else if (request.kind === 'range') {
    const texture = material!.drawRange(request.rows, request.cols, request.seed);
    scope.postMessage({ kind: 'texture', subspace: 0, texture }, [texture.buffer as ArrayBuffer]);
    scope.postMessage({ kind: 'drawn' });
  } else {
    material!.draw(request.options, (subspace, texture) => {
      scope.postMessage({ kind: 'texture', subspace, texture }, [texture.buffer as ArrayBuffer]);
    });
    scope.postMessage({ kind: 'drawn' });
  }
}

scope.onmessage = (event) => {
  answer(event.data).catch((error: unknown) => {
    const message = error instanceof Error ? error.message : String(error);
    scope.postMessage({ kind: 'failed', message });
  });
};
