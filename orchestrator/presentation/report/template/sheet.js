// The page as one picture: top view, ribbons and curves at the time that is shown. For PNG and video.

const GAP = 12, LINE = 20, LANE = 16, FONT = "system-ui, sans-serif";

class Sheet {
  constructor(player) {
    this.player = player;
    this.ratio = 0; // pixels of the picture for one of the page
    this.canvas = document.createElement("canvas");
    this.g = /** @type {CanvasRenderingContext2D} */ (this.canvas.getContext("2d"));
  }

  // Draw the page as it is now; sizes are those of the page, and stay as they were first.
  draw() {
    const { player, g } = this, { scene, plots, timeline } = player, plotWidth = plots.all.length ? plots.all[0].place.clientWidth : 0;
    const lanes = timeline.lanes(), places = this.places(plots.all, scene.height + 2 * GAP + lanes.length * (LANE + 3));
    if (!this.ratio) {
      const ratio = Math.min(2, window.devicePixelRatio || 1);
      this.ratio = ratio;
      const even = (size) => 2 * Math.ceil(0.5 * size * ratio);
      this.canvas.width = even(3 * GAP + scene.width + plotWidth);
      this.canvas.height = even(2 * GAP + 2 * LINE + Math.max(...places.ends));
    }
    g.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    g.fillStyle = color("page");
    g.fillRect(0, 0, this.canvas.width, this.canvas.height);
    this.text(player.page.title, GAP, GAP + 14, `600 16px ${FONT}`, color("ink"), scene.width + plotWidth);
    this.text(`${$("clock").textContent}   ${[...$("hud").children].map((node) => node.textContent).join("   ")}`, GAP, GAP + LINE + 14, `600 13px ${FONT}`, color("ink-soft"), scene.width + plotWidth);
    const top = GAP + 2 * LINE;
    g.fillStyle = color("view");
    g.fillRect(GAP, top, scene.width, scene.height);
    g.drawImage(scene.canvas, GAP, top, scene.width, scene.height);
    lanes.forEach((lane, i) => this.lane(lane, top + scene.height + GAP + i * (LANE + 3)));
    plots.all.forEach((plot, i) => { const [column, y] = places.all[i]; this.plot(plot, column ? 2 * GAP + scene.width : GAP, top + y, plotWidth); });
    return this.canvas;
  }

  // Column and height at which each plot stands: beside the top view, and under the ribbons, where there is room first.
  places(plots, ribbons) {
    const ends = [ribbons, 0];
    const all = plots.map((plot) => {
      const column = ends[0] < ends[1] ? 0 : 1, y = ends[column];
      ends[column] += LINE + plot.u.height + 6;
      return [column, y];
    });
    return { all, ends };
  }

  text(words, x, y, font, ink, room) {
    this.g.font = font;
    this.g.textAlign = "left";
    this.g.fillStyle = ink;
    this.g.fillText(words, x, y, room);
  }

  lane({ label, spans, duration }, y) {
    const { g, player } = this, label_width = 90, width = player.scene.width - label_width;
    this.text(label, GAP, y + 12, `11px ${FONT}`, color("ink-soft"), label_width - 6);
    for (const span of spans) {
      const x = GAP + label_width + width * span.from / duration, long = width * (span.to - span.from) / duration;
      g.fillStyle = span.color;
      g.fillRect(x, y, Math.max(0.5, long - 0.5), LANE);
      if (long > 7 * span.words.length + 6) this.text(span.words, x + 4, y + 12, `10.5px ${FONT}`, color("on-hue"), long - 6);
    }
    g.fillStyle = color("ink");
    g.fillRect(GAP + label_width + width * Math.min(1, player.shown / duration) - 1, y - 2, 2, LANE + 4);
  }

  plot(plot, x, y, width) {
    const { g } = this, { u } = plot;
    g.fillStyle = color("card");
    g.fillRect(x, y, width, LINE + u.height);
    this.text(plot.spec.title, x + 4, y + 14, `600 12px ${FONT}`, color("ink"), 0.3 * width);
    g.font = `600 12px ${FONT}`;
    let at = x + 14 + Math.min(0.3 * width, g.measureText(plot.spec.title).width);
    for (const cell of plot.cells) {
      const words = `${plot.label(cell)} ${cell.value.textContent}`;
      this.text(words, at, y + 14, `11px ${FONT}`, plot.stroke(cell), Math.max(10, x + width - at));
      at += g.measureText(words).width + 12;
    }
    g.drawImage(u.ctx.canvas, x, y + LINE, width, u.height);
    for (const [time, ink] of [[this.player.shown, "ink"], [plot.plots.mark, "accent"]]) {
      const left = time === null ? -1 : u.valToPos(time, "x");
      if (left < 0 || left > u.over.clientWidth) continue;
      g.fillStyle = color(ink);
      g.fillRect(x + u.bbox.left / devicePixelRatio + left, y + LINE + u.bbox.top / devicePixelRatio, 1.5, u.bbox.height / devicePixelRatio);
    }
  }
}

