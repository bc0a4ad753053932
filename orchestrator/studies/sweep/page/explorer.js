"use strict";
// Maps of a study: point at cells, select some, zoom to them, list their runs, replay any of them.
(() => {
  const LEFT = 84, RIGHT = 518, TOP = 8, BOTTOM = 286, TICKS = 8; // the frame of a map (figures.py) [px]
  const SVG = "http://www.w3.org/2000/svg";
  const data = JSON.parse(document.getElementById("runs").textContent);

  function element(tag, attributes, ...children) {
    const node = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes || {})) if (value !== false) node.setAttribute(key, value === true ? "" : value);
    node.append(...children);
    return node;
  }

  class StudyMap {
    constructor(figure, map) {
      this.map = map;
      this.svg = figure.querySelector("svg");
      this.cells = [...this.svg.querySelectorAll("rect.cell")].map((node) => ({ node, c: Number(node.dataset.c), r: Number(node.dataset.r) }));
      this.all = [0, map.labels[0].length - 1, 0, map.labels[1].length - 1]; // first and last column, first and last row
      this.view = this.all;
      this.at = [0, 0];
      this.status = element("p", { class: "quiet", role: "status" }, "Click a cell, or drag over several, to list their runs.");
      this.zoomIn = element("button", { type: "button", disabled: true }, "Zoom to selection");
      this.zoomOut = element("button", { type: "button", disabled: true }, "Whole map");
      this.list = element("div", {});
      figure.append(element("p", { class: "maptools" }, this.zoomIn, " ", this.zoomOut), this.status, this.list);
      this.zoomIn.addEventListener("click", () => this.show(this.selected));
      this.zoomOut.addEventListener("click", () => this.show(this.all));
      this.svg.setAttribute("tabindex", "0");
      this.svg.addEventListener("keydown", (event) => this.key(event));
      this.svg.addEventListener("pointerdown", (event) => this.begin(event));
      this.svg.addEventListener("pointermove", (event) => this.drag(event));
      this.svg.addEventListener("pointerup", () => { if (this.from) { this.from = null; this.choose(this.selected); } });
    }

    place(event) { const node = event.target.closest("rect.cell"); return node && [Number(node.dataset.c), Number(node.dataset.r)]; }

    begin(event) {
      this.from = this.place(event);
      if (this.from) this.mark([this.from[0], this.from[0], this.from[1], this.from[1]]);
    }

    drag(event) {
      const to = this.from && this.place(event);
      if (!to) return;
      const [a, b] = [this.from, to];
      this.mark([Math.min(a[0], b[0]), Math.max(a[0], b[0]), Math.min(a[1], b[1]), Math.max(a[1], b[1])]);
    }

    key(event) {
      const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (way) {
        this.at = [0, 1].map((i) => Math.min(this.view[2 * i + 1], Math.max(this.view[2 * i], this.at[i] + way[i])));
        this.mark([this.at[0], this.at[0], this.at[1], this.at[1]]);
      } else if (event.key === "Enter" && this.selected) this.choose(this.selected);
      else return;
      event.preventDefault();
    }

    mark(selected) {
      this.selected = selected;
      this.at = [selected[0], selected[2]];
      for (const { node, c, r } of this.cells) node.classList.toggle("chosen", c >= selected[0] && c <= selected[1] && r >= selected[2] && r <= selected[3]);
    }

    choose([c0, c1, r0, r1]) {
      const rows = [];
      let count = 0;
      for (const [place, found] of Object.entries(this.map.cells)) {
        const [r, c] = place.split(",").map(Number);
        if (c < c0 || c > c1 || r < r0 || r > r1) continue;
        rows.push(...found);
        count += this.map.count[r][c];
      }
      rows.sort((a, b) => a - b);
      this.zoomIn.disabled = c1 - c0 >= this.view[1] - this.view[0] && r1 - r0 >= this.view[3] - this.view[2];
      this.status.textContent = `${count} run${count === 1 ? "" : "s"}${rows.length < count ? `, ${rows.length} listed` : ""}`;
      const head = element("tr", {}, ...["row", "", "outcome", "reason", "time", ...data.heads].map((text) => element("th", {}, text)));
      const body = element("tbody", {}, ...rows.slice(0, 200).map((row) => this.line(row)));
      this.list.replaceChildren(element("div", { class: "scroll runs", tabindex: "0" }, element("table", {}, element("thead", {}, head), body)));
    }

    line(row) {
      const [outcome, kind, reason, time, ...values] = data.rows[row];
      const cells = [String(row), this.replay(row), element("span", { class: `pill ${kind}` }, outcome), reason, time, ...values];
      return element("tr", {}, ...cells.map((cell) => element("td", {}, cell)));
    }

    // One click: the page that runs the models computes the run and plays it.
    replay(row) {
      if (!data.live) return element("code", {}, `--row ${row}`);
      const parts = data.names.map((name, i) => `${encodeURIComponent(name)}=${data.values[row][i]}`);
      return element("a", { href: `${data.live}#s=${encodeURIComponent(data.scenario)}&play=1&${parts.join("&")}`, target: "_blank", rel: "noopener", "aria-label": `Replay row ${row}` }, "replay");
    }

    // Draw the cells of a part of the map over the whole frame, with the labels of that part.
    show(view) {
      this.view = view;
      const [c0, c1, r0, r1] = view, [xs, ys] = this.map.edges;
      const x = (i) => LEFT + (RIGHT - LEFT) * (xs[i] - xs[c0]) / (xs[c1 + 1] - xs[c0]);
      const y = (i) => BOTTOM - (BOTTOM - TOP) * (ys[i] - ys[r0]) / (ys[r1 + 1] - ys[r0]);
      for (const { node, c, r } of this.cells) {
        const isIn = c >= c0 && c <= c1 && r >= r0 && r <= r1;
        node.style.display = isIn ? "" : "none";
        if (!isIn) continue;
        for (const [key, value] of Object.entries({ x: x(c), y: y(r + 1), width: x(c + 1) - x(c) + 0.3, height: y(r) - y(r + 1) + 0.3 })) node.setAttribute(key, value.toFixed(2));
      }
      for (const node of this.svg.querySelectorAll("text.tick")) node.remove();
      this.ticks(c0, c1, (i) => ({ x: 0.5 * (x(i) + x(i + 1)), y: BOTTOM + 16, "text-anchor": "middle" }), this.map.labels[0], (RIGHT - LEFT) / TICKS, "x");
      this.ticks(r0, r1, (i) => ({ x: LEFT - 6, y: 0.5 * (y(i) + y(i + 1)) + 4, "text-anchor": "end" }), this.map.labels[1], (BOTTOM - TOP) / (2 * TICKS), "y");
      this.zoomOut.disabled = view === this.all;
      this.zoomIn.disabled = true;
    }

    ticks(first, last, at, labels, least, along) {
      let before = -Infinity;
      for (let i = first; i <= last; i++) {
        const place = at(i);
        if (Math.abs(place[along] - before) < least) continue;
        before = place[along];
        const text = document.createElementNS(SVG, "text");
        text.setAttribute("class", "tick");
        for (const [key, value] of Object.entries(place)) text.setAttribute(key, typeof value === "number" ? value.toFixed(1) : value);
        text.textContent = labels[i];
        this.svg.append(text);
      }
    }
  }

  window.study = [...document.querySelectorAll("figure[data-map]")].map((figure, i) => new StudyMap(figure, data.maps[i]));
})();
