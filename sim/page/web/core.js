"use strict";
/* The C module: its memory, its texts, and the numbers that a scene shows, by their names. */

class Core {
  /** From the module's bytes in base64 (core.wasm.js). */
  static async load(base64) {
    const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
    const core = new Core();
    const { instance } = await WebAssembly.instantiate(bytes, { wasi_snapshot_preview1: core.system() });
    core.exports = instance.exports;
    core.exports._initialize();
    return core;
  }

  constructor() {
    this.error = ""; // the last line that the C printed on stderr
    this.names = {};
  }

  /** What wasi-libc asks of its system: to print an error line, no more. */
  system() {
    const write = (file, vectors, count, written) => {
      const view = new DataView(this.exports.memory.buffer);
      let total = 0;
      let text = "";
      for (let i = 0; i < count; i++) {
        const length = view.getUint32(vectors + 8 * i + 4, true);
        text += new TextDecoder().decode(new Uint8Array(this.exports.memory.buffer, view.getUint32(vectors + 8 * i, true), length));
        total += length;
      }
      view.setUint32(written, total, true);
      this.error = text.trim() || this.error;
      return 0;
    };
    const refuse = () => 8; // EBADF
    return { fd_write: write, fd_close: refuse, fd_seek: refuse };
  }

  text(pointer) {
    const bytes = new Uint8Array(this.exports.memory.buffer, pointer);
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }

  doubles(pointer, count) {
    return new Float64Array(this.exports.memory.buffer, pointer, count);
  }

  /** The numbers of a scene, as an object. */
  view(scene) {
    this.names[scene] ??= this.text(this.exports[`${scene}_view_names`]()).trim().split(" ");
    const names = this.names[scene];
    const numbers = this.doubles(this.exports[`${scene}_view`](), names.length);
    return Object.fromEntries(names.map((name, i) => [name, numbers[i]]));
  }

  /** What the library says of a request that it refuses (joulepath/status.h). */
  static reason(status) {
    return {
      "-1": "an argument is out of its range",
      "-3": "no motion satisfies every limit: move the waypoints apart",
      "-4": "two waypoints coincide, or the first is where the robot stands",
      "-5": "the energy model is not physical",
      "-6": "it takes more than can be counted",
      "-7": "not in this state: reset first",
      "-8": "an earlier command still waits",
      "-10": "the memory is too small",
      "-12": "that is outside the map",
      "-13": "the robot does not fit there",
      "-15": "there is no way",
    }[status] ?? `status ${status}`;
  }
}
