// The stream of pictures: messages one behind the other, see verification/explore/streams.py.

const SIZES = 8; // bytes: of the header and of the payload, uint32 each

/** The messages of an address as they come: [header, DataView of the payload]. */
export async function* messages(url, signal) {
  const answer = await fetch(url, { signal, cache: "no-store" });
  if (!answer.ok) throw new Error(`the server answers ${answer.status}`);
  const reader = answer.body.getReader();
  let rest = new Uint8Array(0);
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    rest = joined(rest, value);
    for (let size = sizeOf(rest); size !== null && rest.length >= size; size = sizeOf(rest)) {
      yield parsed(rest.slice(0, size)); // a copy, so that numbers lie at multiples of 4
      rest = rest.subarray(size);
    }
  }
}

function joined(first, second) {
  const both = new Uint8Array(first.length + second.length);
  both.set(first);
  both.set(second, first.length);
  return both;
}

/** Bytes of the first message, null if even that is not known yet. */
function sizeOf(bytes) {
  if (bytes.length < SIZES) return null;
  const view = new DataView(bytes.buffer, bytes.byteOffset, SIZES);
  return SIZES + view.getUint32(0, true) + view.getUint32(4, true);
}

function parsed(bytes) {
  const length = new DataView(bytes.buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(SIZES, SIZES + length)));
  return [header, new Columns(bytes.buffer, SIZES + length)];
}

/** Columns of 4-byte numbers, taken one after the other. */
class Columns {
  constructor(buffer, place) {
    this.buffer = buffer;
    this.place = place;
  }

  integers(n) {
    return this.next(Int32Array, n);
  }

  numbers(n) {
    return this.next(Float32Array, n);
  }

  next(type, n) {
    const column = new type(this.buffer, this.place, n);
    this.place += 4 * n;
    return column;
  }
}
