// What one takes home from the page: a picture, numbers, a video.

const VIDEO = ["video/webm;codecs=vp8", "video/webm;codecs=vp9", "video/mp4"];
const RATE = 30; // pictures a second
const HELD = 500, LATEST_END = 8000; // how long the last picture stays, and at most, while the encoder has given nothing yet [ms]
const HEADER = 2000; // more than a file without pictures has [bytes]

function handOut(name, blob) {
  const link = element("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const cell = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

// The curves on the page over the time that is shown, in the units of the page, at all instants of all runs.
function csv(plots) {
  const [from, to] = plots.range, curves = plots.all.flatMap((plot) => plot.curves.map((curve) => ({ ...curve, plot })));
  const once = [...new Map(curves.map((curve) => [`${curve.number} ${curve.name}`, curve])).values()];
  const times = [...new Set(plots.page.runs.flatMap((run) => Array.from(run.time)))].filter((t) => t >= from && t <= to).sort((a, b) => a - b);
  const columns = once.map(({ run, name, plot }) => {
    const { unit, states } = plot.signal(name), [shown, factor] = display(unit), title = `${run.label ? `${run.label}: ` : ""}${name}${shown ? ` [${shown}]` : ""}`;
    return { title, at: (t) => (t > run.duration ? "" : states ? run.stateName(name, run.at(name, t)) : String(Number((run.at(name, t) * factor).toPrecision(7)))) };
  });
  const lines = [["time [s]", ...columns.map(({ title }) => title)], ...times.map((t) => [String(Number(t.toFixed(9))), ...columns.map(({ at }) => at(t))])];
  return `${lines.map((line) => line.map(cell).join(",")).join("\n")}\n`;
}

class Keeper {
  constructor(player) {
    this.player = player;
    this.name = player.page.name || "run";
    this.recorder = null;
    $("png").addEventListener("click", () => new Sheet(player).draw().toBlob((blob) => handOut(`${this.name}-${player.shown.toFixed(2)}s.png`, blob), "image/png"));
    $("csv").addEventListener("click", () => handOut(`${this.name}.csv`, new Blob([csv(player.plots)], { type: "text/csv" })));
    this.kind = window.MediaRecorder ? VIDEO.find((kind) => MediaRecorder.isTypeSupported(kind)) || "" : "";
    $("video").hidden = !this.kind;
    $("video").addEventListener("click", () => { if (this.recorder) this.stop(); else this.record(); });
  }

  // Play the time that is shown once, at the speed chosen, and hand it out as a video.
  record() {
    const { player } = this, [from, to] = player.plots.range, sheet = new Sheet(player), parts = [];
    player.pause();
    player.seek(from);
    const stream = sheet.draw().captureStream(RATE);
    this.recorder = new MediaRecorder(stream, { mimeType: this.kind, videoBitsPerSecond: 6e6 });
    this.recorder.ondataavailable = ({ data }) => parts.push(data);
    this.recorder.onstop = () => {
      this.recorder = null;
      for (const track of stream.getTracks()) track.stop();
      $("video").textContent = "Video";
      handOut(`${this.name}.${this.kind.includes("mp4") ? "mp4" : "webm"}`, new Blob(parts, { type: this.kind }));
    };
    this.recorder.start(250);
    $("video").textContent = "Stop recording";
    player.play();
    let over = 0;
    const frame = () => {
      if (!this.recorder) return;
      sheet.draw();
      if (player.playing && player.t >= to) player.pause();
      if (!player.playing && !over) over = performance.now();
      const held = over ? performance.now() - over : 0, size = parts.reduce((sum, part) => sum + part.size, 0);
      if (held > (size > HEADER ? HELD : LATEST_END)) this.stop(); else requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  }

  stop() {
    this.player.pause();
    if (this.recorder && this.recorder.state !== "inactive") this.recorder.stop();
  }
}
