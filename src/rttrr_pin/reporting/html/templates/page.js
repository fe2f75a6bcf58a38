
"use strict";
// What a pointer or a key does with the pictures; a page says everything without it.
(() => {
  const ACROSS = 1000, LEAST = 0.002;
  const view = { from: 0, to: 1 }; // the part of the time that is shown, in all pictures over time

  const make = (tag, properties) => Object.assign(document.createElement(tag), properties);
  const set = (element, attributes) => Object.entries(attributes).forEach(([name, value]) => element.setAttribute(name, value));

  const svg = (tag, attributes, text) => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
    set(made, attributes);
    return text === undefined ? made : Object.assign(made, { textContent: text });
  };

  const number = (x) => { // four digits, as the page writes them
    if (x === null) return "no number";
    const words = x !== 0 && Math.abs(x) < 1e-4 ? x.toExponential(3) : x.toPrecision(4);
    const [digits, exponent] = words.split("e");
    return (digits.includes(".") ? digits.replace(/\.?0+$/, "") : digits) + (exponent ? `e${Number(exponent)}` : "");
  };

  const ticks = (low, high) => {
    const rough = (high - low) / 6, power = 10 ** Math.floor(Math.log10(rough));
    const step = ([1, 2, 5].find((k) => k * power >= rough * (1 - 1e-9)) || 10) * power;
    const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
    return [Array.from({ length: last - first + 1 }, (_, k) => (first + k) * step), step];
  };

  class Picture {
    constructor(figure) {
      this.figure = figure;
      this.data = JSON.parse(figure.querySelector("script").textContent);
      this.svg = figure.querySelector("svg.chart");
      this.inner = this.svg.querySelector("svg.plot");
      this.timed = this.data.kind === "time";
      [this.left, this.top, this.width, this.height] = this.data.plot;
      this.read = make("div", { className: "read", hidden: true, ariaLive: "polite" });
      figure.append(this.read);
      this.cursor = this.svg.appendChild(this.timed ? svg("line", { class: "cursor", y1: this.top, y2: this.top + this.height }) : svg("circle", { class: "spot", r: 5 }));
      this.cursor.setAttribute("visibility", "hidden");
      this.index = -1;
      this.svg.setAttribute("tabindex", "0");
      const react = { pointermove: (event) => this.move(event), pointerleave: () => this.leave(), blur: () => this.leave(), keydown: (event) => this.key(event) };
      for (const [name, action] of Object.entries(react)) this.svg.addEventListener(name, action);
      this.toggles();
      if (this.timed) this.dragging();
    }

    get shown() { // the numbers at the edges of the plot
      const [low, high] = this.data.at;
      return [view.from, view.to].map((part) => low + part * (high - low));
    }

    place(event) { // a pointer in units of the picture
      const box = this.svg.getBoundingClientRect(), scale = this.svg.viewBox.baseVal.width / box.width;
      return [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
    }

    at(i) { // a point in units of the picture
      const [low, high] = this.timed ? this.shown : this.data.at;
      const x = this.left + (this.data.x[i] - low) / (high - low) * this.width;
      if (this.timed) return [x, this.top + this.height / 2];
      const [, , bottom, top] = this.data.at;
      return [x, this.top + (top - this.data.y[i]) / (top - bottom) * this.height];
    }

    move(event) {
      const [x, y] = this.place(event);
      if (x < this.left - 4 || x > this.left + this.width + 4) return this.leave();
      let best = -1, least = this.timed ? Infinity : 400;
      for (let i = 0; i < this.data.x.length; i += 1) {
        const [a, b] = this.at(i), far = this.timed ? Math.abs(a - x) : (a - x) ** 2 + (b - y) ** 2;
        if (far < least) [best, least] = [i, far];
      }
      return best < 0 ? this.leave() : this.show(best);
    }

    key(event) {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (event.key === "Escape") this.leave();
      if (!step) return;
      event.preventDefault(); // no scrolling
      const last = this.data.x.length - 1, [low, high] = this.timed ? this.shown : [-Infinity, Infinity];
      const begun = this.index < 0 ? this.data.x.findIndex((x) => x >= low && x <= high) : this.index + step;
      this.show(Math.min(Math.max(begun, 0), last));
    }

    show(i) {
      this.index = i;
      const [x, y] = this.at(i), scale = this.svg.getBoundingClientRect().width / this.svg.viewBox.baseVal.width;
      set(this.cursor, this.timed ? { x1: x, x2: x } : { cx: x, cy: y });
      this.cursor.removeAttribute("visibility");
      this.read.textContent = this.lines(i).join("\n");
      this.read.hidden = false;
      const wide = this.read.offsetWidth, room = this.figure.clientWidth, left = x * scale + 12 + wide < room ? x * scale + 12 : x * scale - wide - 12;
      this.read.style.left = `${Math.max(0, Math.min(left, room - wide))}px`;
      this.read.style.top = `${this.svg.offsetTop + (this.top + 4) * scale}px`;
    }

    lines(i) {
      const [x, y] = this.data.unit, named = (label, value) => label.includes(" [") ? label.replace(" [", ` ${value} [`).replace(/\[(.*)\]$/, "$1") : `${label} ${value}`;
      if (!this.timed) {
        const extra = Object.entries(this.data.extra).map(([name, values]) => named(name, number(values[i])));
        return [named(x, number(this.data.x[i])), named(y, number(this.data.y[i])), ...extra];
      }
      const unit = (y.match(/\[(.*)\]$/) || ["", ""])[1];
      const range = (one) => one.high && one.high[i] !== one.low[i] ? `${number(one.low[i])} to ${number(one.high[i])}` : number(one.low[i]);
      return [named(x, number(this.data.x[i])), ...this.data.series.map((one) => `${one.name}: ${range(one)} ${unit}`)];
    }

    leave() {
      this.index = -1;
      this.read.hidden = true;
      this.cursor.setAttribute("visibility", "hidden");
    }

    toggles() {
      for (const item of this.figure.querySelectorAll("li[data-hides]")) {
        const button = make("button", { type: "button", ariaPressed: "true" });
        button.append(...item.childNodes);
        button.addEventListener("click", () => {
          const on = button.ariaPressed !== "true";
          button.ariaPressed = on;
          for (const part of this.inner.querySelectorAll(`[data-series="${item.dataset.hides}"]`)) part.style.display = on ? "" : "none";
        });
        item.append(button);
      }
    }

    dragging() {
      let begun = null, box = null;
      this.svg.addEventListener("pointerdown", (event) => {
        const [x] = this.place(event);
        if (event.button !== 0 || x < this.left || x > this.left + this.width) return;
        begun = x;
        box = this.svg.appendChild(svg("rect", { class: "chosen", y: this.top, height: this.height, width: 0 }));
        this.svg.setPointerCapture(event.pointerId);
      });
      const edges = (event) => [begun, this.place(event)[0]].sort((a, b) => a - b).map((x) => Math.min(Math.max(x, this.left), this.left + this.width));
      this.svg.addEventListener("pointermove", (event) => {
        const [a, b] = begun === null ? [] : edges(event);
        if (begun !== null) set(box, { x: a, width: b - a });
      });
      const end = (event, choose) => {
        if (begun === null) return;
        const [a, b] = edges(event).map((x) => view.from + (x - this.left) / this.width * (view.to - view.from));
        const far = Math.abs(this.place(event)[0] - begun);
        box.remove();
        begun = null;
        if (choose && far > 6) look(a, b);
      };
      const react = { pointerup: (event) => end(event, true), pointercancel: (event) => end(event, false), dblclick: () => look(0, 1) };
      for (const [name, action] of Object.entries(react)) this.svg.addEventListener(name, action);
    }

    redraw() {
      this.inner.setAttribute("viewBox", `${ACROSS * view.from} 0 ${ACROSS * (view.to - view.from)} ${this.height}`);
      const group = this.svg.querySelector("g.ticks"), [low, high] = this.shown, bottom = this.top + this.height;
      const [values, step] = ticks(low, high), digits = Math.max(0, Math.min(12, -Math.floor(Math.log10(step) + 1e-9)));
      group.replaceChildren(...values.flatMap((value) => {
        const x = this.left + (value - low) / (high - low) * this.width;
        const word = Math.abs(value) < 1e6 && digits < 6 ? String(Number(value.toFixed(digits))) : number(value);
        return [svg("line", { x1: x, x2: x, y1: bottom, y2: bottom + 4, class: "axis" }), svg("text", { x, y: bottom + 17, class: "tick middle" }, word)];
      }));
      this.leave();
    }
  }

  const pictures = [...document.querySelectorAll("figure")].filter((one) => one.querySelector("script")).map((one) => new Picture(one));
  const timed = pictures.filter((one) => one.timed);
  const said = make("output", { className: "dim" });

  const look = (from, to) => {
    const wide = Math.min(Math.max(to - from, LEAST), 1), begin = Math.min(Math.max(from, 0), 1 - wide);
    Object.assign(view, { from: begin, to: begin + wide });
    timed.forEach((one) => one.redraw());
    const [low, high] = timed[0].shown;
    said.textContent = `${number(low)} to ${number(high)} s`;
  };

  if (timed.length) {
    const tools = make("div", { className: "tools", role: "toolbar", ariaLabel: "Time shown" });
    const middle = () => (view.from + view.to) / 2, wide = () => view.to - view.from;
    const actions = {
      "Zoom in": () => look(middle() - wide() / 4, middle() + wide() / 4), "Zoom out": () => look(middle() - wide(), middle() + wide()),
      "Earlier": () => look(view.from - wide() / 2, view.to - wide() / 2), "Later": () => look(view.from + wide() / 2, view.to + wide() / 2), "All": () => look(0, 1),
    };
    for (const [name, action] of Object.entries(actions)) {
      const button = make("button", { type: "button", textContent: name });
      button.addEventListener("click", action);
      tools.append(button);
    }
    tools.append(said);
    timed[0].figure.closest(".figures").before(tools);
    look(0, 1);
  }
})();
