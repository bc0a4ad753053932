// The models as they are in the page: a WebAssembly module (fmus/native/c/live.c), its runs, and numbers to and from it.

const HOW = ["last", "largest", "greatest", "smallest", "travel", "first", "time"];
const HEAD = 2; // a row begins with how the run ended and when [ns]

async function inflate(text) {
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

class Engine {
  // `code`: bytes of the module; `models`: what described.py says of them.
  static async start(code, models) {
    const { instance } = await WebAssembly.instantiate(code, {});
    return new Engine(instance.exports, models);
  }

  constructor(exports, models) {
    this.c = exports;
    this.models = models;
    this.c._initialize();
    this.places = new Map(); // signal -> [model, place, is input]
    models.forEach((model, number) => {
      model.inputs.forEach((item, place) => this.places.set(`${model.name}.${item[0]}`, [number, place, 1]));
      model.outputs.forEach((item, place) => this.places.set(`${model.name}.${item[0]}`, [number, place, 0]));
    });
  }

  view(address, count) { return new Float64Array(this.c.memory.buffer, address, count); }

  put(numbers) {
    const address = this.c.live_numbers(Math.max(1, numbers.length));
    this.view(address, numbers.length).set(numbers);
    return address;
  }

  open(situation, seen) { return new Course(this, situation, seen); }
}

// Runs of one scenario: whole ones, or one that goes on step by step. Parameters may differ from run to run.
class Course {
  constructor(engine, data, seen) {
    this.engine = engine;
    this.c = engine.c;
    this.seen = seen;
    this.kept = data.measures.length;
    const place = (name) => engine.places.get(name), bits = (values) => values.reduce((sum, value) => sum + 2 ** value, 0);
    const { receivers } = data.faults, inputs = receivers.flatMap(([, , ...places]) => places);
    const numbers = [bits(data.ending.final), data.ending.still, data.ending.standstill_ns, ...place(data.ending.mode), ...place(data.ending.speed), this.kept, seen.length, receivers.length, inputs.length];
    for (const [how, name, mode, values] of data.measures)
      numbers.push(HOW.indexOf(how), ...place(name), ...(mode ? place(mode) : [0, 0, 0]), mode ? bits(values) : 0);
    for (const name of seen) numbers.push(...place(name));
    for (const [kind, model, ...places] of receivers) numbers.push(kind, model, places.length, ...places);
    const address = engine.put(numbers);
    this.live = this.c.live_open(address);
    this.c.live_free(address);
    if (!this.live) throw new Error("there is not enough memory");
    this.faults = engine.put(data.faults.numbers.map((value) => value ?? NaN));
    this.line = engine.put(seen.map(() => 0));
    this.times = engine.put([0, 0, 0, 0]);
    this.params = this.room = this.trace = 0; // addresses of numbers, and how many lines a trace has room for
  }

  close() {
    this.c.live_close(this.live);
    for (const address of [this.line, this.times, this.params, this.faults, this.trace]) if (address) this.c.live_free(address);
  }

  give(params, times) {
    if (!this.params) this.params = this.engine.put(params);
    this.engine.view(this.params, params.length).set(params);
    this.engine.view(this.times, 4).set(times);
  }

  // A whole run: how it ended, and every n-th exchange as a line [time, what is seen].
  run(params, times, every = 1) {
    const room = Math.ceil(Math.floor(times[1] / times[0]) / every) + 2, width = this.seen.length + 1;
    this.give(params, times);
    if (!(this.room >= room)) {
      if (this.trace) this.c.live_free(this.trace);
      this.trace = this.c.live_numbers(room * width);
      this.room = room;
    }
    const lines = this.c.live_run(this.live, this.params, this.times, this.faults, this.trace, every, room);
    if (!lines) throw new Error("there is not enough memory");
    return { row: this.row(), width, lines, trace: this.engine.view(this.trace, lines * width) };
  }

  row() { return Float64Array.from(this.engine.view(this.c.live_row(this.live), HEAD + this.kept)); }

  begin(params, times) {
    this.give(params, times);
    if (this.c.live_begin(this.live, this.params, this.times, this.faults)) throw new Error("there is not enough memory");
  }

  // One exchange; returns what is seen and whether the run is over.
  exchange() {
    const over = this.c.live_exchange(this.live, this.line) !== 0;
    return { over, seen: this.engine.view(this.line, this.seen.length) };
  }

  advance() { this.c.live_advance(this.live); }

  // What the chart in `place` decided on last: the exchange before it did, or -1; its state then; the guards as bits.
  decided(place) { return this.engine.view(this.c.live_decided(this.live), 3 * (place + 1)).subarray(3 * place); }

  set(name, value) {
    const [model, place] = this.engine.places.get(name);
    this.c.live_set(this.live, model, place, value);
  }

  look(name) {
    const place = this.engine.places.get(name);
    return place ? this.c.live_look(this.live, ...place) : NaN;
  }
}
