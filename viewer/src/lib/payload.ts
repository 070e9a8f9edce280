// SPDX-License-Identifier: Apache-2.0
// The gzip wrapping of material files, undone by the browser.
import { SateenError } from './runtime';

/** Larger payloads are refused, as kMaxPayloadBytes of material/file.hpp says. */
export const MAX_PAYLOAD_BYTES = 16 << 20;

/** The payload of a `.sateen` file. Reads no further than the limit, whatever the file claims. */
export async function unpack(file: Uint8Array): Promise<Uint8Array> {
  if (file.length < 18 || file[0] !== 0x1f || file[1] !== 0x8b)
    throw new SateenError('not a Sateen material: expected a gzip file');
  const stream = new Blob([file as BlobPart]).stream().pipeThrough(new DecompressionStream('gzip'));
  const reader = stream.getReader();
  const parts: Uint8Array[] = [];
  let length = 0;
  for (;;) {
    let part;
    try {
      part = await reader.read();
    } catch {
      throw new SateenError('the file is truncated or damaged');
    }
    if (part.done) break;
    length += part.value.length;
    if (length > MAX_PAYLOAD_BYTES) {
      await reader.cancel();
      throw new SateenError(`unpacks to more than ${MAX_PAYLOAD_BYTES >> 20} MB, no material does`);
    }
    parts.push(part.value);
  }
  const payload = new Uint8Array(length);
  let at = 0;
  for (const part of parts) {
    payload.set(part, at);
    at += part.length;
  }
  return payload;
}
