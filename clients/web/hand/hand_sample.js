// A hand sample as the tracker's protobuf message (proto/teachpath_proto/teachpath/v1/tracker.proto, HandSample).
const GRASP_BUTTON = 1; // button bit: grasp held
const CLUTCH_BUTTON = 4; // button bit: the arm follows the hand

/**
 * @param {HandSample & {sequence: number}} sample `ms` is the device's clock in milliseconds since the Unix epoch;
 *   microseconds are kept
 */
export function encodeHandSample({ sequence, ms, position, orientation, tracked, grasp, clutch }) {
  const out = new ProtobufWriter();
  out.varint(1, BigInt(sequence));
  out.varint(2, BigInt(Math.round(ms * 1000)) * 1000n);
  out.doubles(3, position);
  if (orientation) out.doubles(4, orientation);
  if (tracked) out.varint(6, 1n);
  if (grasp || clutch) out.varint(7, BigInt((grasp ? GRASP_BUTTON : 0) | (clutch ? CLUTCH_BUTTON : 0)));
  return out.bytes();
}

class ProtobufWriter {
  #buffer = new ArrayBuffer(128);
  #view = new DataView(this.#buffer);
  #at = 0;

  /**
   * A field with wire type 0.
   * @param {number} number
   * @param {bigint} value
   */
  varint(number, value) {
    this.#byte(number << 3);
    for (; value > 127n; value >>= 7n) this.#byte(Number(value & 127n) | 128);
    this.#byte(Number(value));
  }

  /**
   * A field with a message of doubles, numbered from 1: wire type 2, inside it wire type 1.
   * @param {number} number
   * @param {number[]} values
   */
  doubles(number, values) {
    this.#byte((number << 3) | 2);
    this.#byte(9 * values.length);
    for (const [i, value] of values.entries()) {
      this.#byte(((i + 1) << 3) | 1);
      this.#view.setFloat64(this.#at, value, true);
      this.#at += 8;
    }
  }

  bytes() {
    return new Uint8Array(this.#buffer, 0, this.#at);
  }

  /** @param {number} value */
  #byte(value) {
    this.#view.setUint8(this.#at++, value);
  }
}
