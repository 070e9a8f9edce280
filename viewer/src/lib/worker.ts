// SPDX-License-Identifier: Apache-2.0
// Draws in the background: one worker a material. To cancel is to end the worker.
import { type Description, type DrawOptions, type LoadedMaterial, Runtime } from './runtime';

export type Request =
  | { kind: 'load'; module: WebAssembly.Module; payload: Uint8Array }
  | { kind: 'draw'; options: DrawOptions };

export type Reply =
  | { kind: 'loaded'; description: Description }
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
  } else {
    material!.draw(request.options, (subspace, texture) => {
      scope.postMessage({ kind: 'texture', subspace, texture }, [texture.buffer]);
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
