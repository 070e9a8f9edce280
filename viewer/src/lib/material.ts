// SPDX-License-Identifier: Apache-2.0
// A material in the browser: loaded from an address or bytes, drawn in a worker.
import { unpack } from './payload';
import { type DrawOptions, type MaterialData, SateenError } from './runtime';
import type { Drawn, Reply, Request, Torus } from './worker';
import SateenWorker from './worker?worker&inline';
import wasmBase64 from './wasm';

let compiled: Promise<WebAssembly.Module> | undefined;

/** The runtime, compiled once a page. It is part of the bundle: nothing else is fetched. */
function runtimeModule(): Promise<WebAssembly.Module> {
  compiled ??= (async () => {
    const packed = Uint8Array.from(atob(wasmBase64), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
    return WebAssembly.compile(await new Response(stream).arrayBuffer());
  })();
  return compiled;
}

export interface DrawProgress extends DrawOptions {
  onTexture?: (subspace: number, texture: Float32Array) => void;
  /** 0 … 1 */
  onProgress?: (share: number) => void;
  signal?: AbortSignal;
}

/** A loaded `.sateen` file. Dispose of it when it is no longer shown. */
export class Material {
  private worker: Worker | undefined;

  private constructor(
    private readonly payload: Uint8Array,
    readonly description: MaterialData,
    /** Size of the file. */
    readonly bytes: number,
    worker: Worker,
  ) {
    this.worker = worker;
  }

  static async fromBytes(file: Uint8Array): Promise<Material> {
    const payload = await unpack(file);
    const { worker, description } = await start(payload);
    return new Material(payload, description, file.length, worker);
  }

  /** Draws toroidal textures one after the other, off the main thread. One call at a time. */
  async draw(options: DrawProgress): Promise<void> {
    const { onTexture, onProgress, signal, ...rest } = options;
    const total = rest.subspaces?.length ?? this.description.subspaces.length;
    let done = 0;
    await this.ask({ kind: 'draw', options: rest }, (subspace, texture) => {
      onTexture?.(subspace, texture);
      onProgress?.(++done / total);
    }, signal);
  }

  /** The textures of all subspaces on a torus as sums of a few components. */
  async basis(torus: Torus, onProgress?: (share: number) => void, signal?: AbortSignal): Promise<Drawn['basis']> {
    return (await this.ask({ kind: 'basis', ...torus }, undefined, signal, onProgress)) as Drawn['basis'];
  }

  /** The range map on a torus, heights in pixels, (rows, cols). */
  async range(torus: Torus, signal?: AbortSignal): Promise<Float32Array> {
    return (await this.ask({ kind: 'range', ...torus }, undefined, signal)) as Float32Array;
  }

  private async ask(
    request: Request, take?: (subspace: number, texture: Float32Array) => void, signal?: AbortSignal,
    onProgress?: (share: number) => void,
  ): Promise<unknown> {
    signal?.throwIfAborted();
    const worker = (this.worker ??= (await start(this.payload)).worker);
    const { promise, resolve, reject } = deferred();
    const stop = (): void => {
      this.dispose();
      reject(signal!.reason);
    };
    signal?.addEventListener('abort', stop, { once: true });
    worker.onmessage = ({ data }: MessageEvent<Reply>) => {
      if (data.kind === 'texture') take?.(data.subspace, data.texture);
      else if (data.kind === 'progress') onProgress?.(data.share);
      else if (data.kind === 'drawn') resolve(data.result);
      else if (data.kind === 'failed') reject(new SateenError(data.message));
    };
    worker.onerror = (event) => reject(new SateenError(event.message || 'the worker failed'));
    worker.postMessage(request);
    try {
      return await promise;
    } finally {
      signal?.removeEventListener('abort', stop);
    }
  }

  /** Ends the worker. Drawing again starts another. */
  dispose(): void {
    this.worker?.terminate();
    this.worker = undefined;
  }
}

interface Deferred {
  promise: Promise<unknown>;
  resolve: (result: unknown) => void;
  reject: (reason: unknown) => void;
}

function deferred(): Deferred {
  const parts = {} as Deferred;
  parts.promise = new Promise((resolve, reject) => Object.assign(parts, { resolve, reject }));
  return parts;
}

async function start(payload: Uint8Array): Promise<{ worker: Worker; description: MaterialData }> {
  const module = await runtimeModule();
  const worker = new SateenWorker();
  try {
    const description = await new Promise<MaterialData>((resolve, reject) => {
      worker.onmessage = ({ data }: MessageEvent<Reply>) => {
        if (data.kind === 'loaded') resolve(data.description);
        else if (data.kind === 'failed') reject(new SateenError(data.message));
      };
      worker.onerror = (event) => reject(new SateenError(event.message || 'the worker failed'));
      worker.postMessage({ kind: 'load', module, payload } satisfies Request);
    });
    return { worker, description };
  } catch (error) {
    worker.terminate();
    throw error;
  }
}

/** Larger files are not read. */
const MAX_FILE_BYTES = 32 << 20;

/** Loads a `.sateen` file: an address, a dropped file, or its bytes. */
export async function loadMaterial(source: string | URL | Blob | Uint8Array): Promise<Material> {
  if (source instanceof Uint8Array) return Material.fromBytes(source);
  let blob: Blob;
  if (source instanceof Blob) blob = source;
  else {
    const response = await fetch(source);
    if (!response.ok)
      throw new SateenError(`${source}: the server answers ${response.status} ${response.statusText}`);
    blob = await response.blob();
  }
  if (blob.size > MAX_FILE_BYTES)
    throw new SateenError(`a file of ${(blob.size / 1e6).toFixed(0)} MB, no material is larger than 32 MB`);
  return Material.fromBytes(new Uint8Array(await blob.arrayBuffer()));
}
