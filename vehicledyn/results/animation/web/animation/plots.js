// Plots beside the scene, with the moment marked.

const byName = scenes.map((scene) => new Map(scene.channels.map((channel) => [channel.name, channel])));

function niceTicks(low, high, count) {
  const span = high - low || Math.abs(high) || 1, raw = span / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((n) => n * power >= raw), ticks = [];
  for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + 1e-9 * span; v += step) ticks.push(Math.abs(v) < 1e-9 * span ? 0 : v);
  return ticks.length > 1 || !(span > 0) || count > 64 ? ticks : niceTicks(low, high, 2 * count);
}

function shown(value) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  return size !== 0 && (size >= 1e5 || size < 1e-3) ? value.toExponential(2) : Number(value.toPrecision(4)).toString();
}

class Plot {
  constructor(choice) {
    this.root = document.createElement("div");
    this.root.className = "plot";
    const head = element(this.root, "div", "head");
    this.select = element(head, "select");
    this.select.setAttribute("aria-label", "What this plot shows");
    const figures = element(this.select, "optgroup");
    figures.label = "Figures";
    scenes[0].panels.forEach((panel, k) => { const o = element(figures, "option"); o.value = `p${k}`; o.textContent = `${panel.title} [${byName[0].get(panel.channels[0]).unit}]`; });
    const all = element(this.select, "optgroup");
    all.label = "Channels";
    scenes[0].channels.forEach((channel, k) => { const o = element(all, "option"); o.value = `c${k}`; o.textContent = channel.name; });
    if (!scenes[0].panels.length) figures.remove();
    this.select.value = choice;
    this.select.addEventListener("change", () => { this.choose(); drawAll(); });
    const remove = element(head, "button");
    remove.type = "button"; remove.textContent = "×"; remove.setAttribute("aria-label", "Remove this plot");
    remove.addEventListener("click", () => { this.root.remove(); plots.splice(plots.indexOf(this), 1); });
    this.area = element(this.root, "div", "area");
    this.canvas = element(this.area, "canvas");
    this.mark = element(this.area, "div", "mark");
    this.list = element(this.root, "ul");
    const drag = (event) => {
      if (event.type === "pointermove" && !event.buttons) return;
      const box = this.area.getBoundingClientRect(), part = (event.clientX - box.left - this.left) / (box.width - this.left - 8);
      seek(begin + Math.min(1, Math.max(0, part)) * (end - begin));
    };
    this.area.addEventListener("pointerdown", (event) => { this.area.setPointerCapture(event.pointerId); drag(event); });
    this.area.addEventListener("pointermove", drag);
    $("plots").append(this.root);
    this.choose();
  }

  choose() {
    const number = Number(this.select.value.slice(1));
    const names = this.select.value[0] === "p" ? scenes[0].panels[number].channels : [scenes[0].channels[number].name];
    this.lines = [];
    names.forEach((name, k) => scenes.forEach((scene, i) => {
      const channel = byName[i].get(name);
      if (channel) this.lines.push({ channel, scene: i, colour: k % OKABE_ITO.length, dashed: i > 0, values: columns[channel.column], times: columns[scene.time] });
    }));
    this.unit = this.lines[0]?.channel.unit ?? "";
    this.list.replaceChildren();
    for (const line of this.lines) {
      const item = element(this.list, "li"), mark = element(item, "i");
      line.mark = mark;
      if (line.dashed) mark.style.borderTopStyle = "dashed";
      const text = element(item, "span");
      text.textContent = line.channel.name;
      text.title = line.channel.text;
      line.value = element(item, "b");
    }
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", `${names.join(", ")} against time`);
  }

  draw() {
    const ratio = devicePixelRatio || 1, { clientWidth: w, clientHeight: h } = this.area;
    if (!w) return;
    this.canvas.width = w * ratio;
    this.canvas.height = h * ratio;
    const pen = this.canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const style = getComputedStyle(document.documentElement), ink = style.getPropertyValue("--soft"), rule = style.getPropertyValue("--line");
    pen.font = "11px system-ui, 'DejaVu Sans', sans-serif";
    let low = Infinity, high = -Infinity;
    for (const { values, channel } of this.lines) for (const v of values) {
      const x = v * channel.factor;
      if (x < low) low = x;
      if (x > high) high = x;
    }
    if (!(high >= low)) { low = 0; high = 1; }
    const room = high - low || Math.abs(high) || 1;
    low -= 0.05 * room; high += 0.05 * room;
    const ticks = niceTicks(low, high, 4), top = 16, bottom = h - 20;
    this.ticks = ticks;
    this.left = Math.ceil(Math.max(...ticks.map((t) => pen.measureText(shown(t)).width))) + 10;
    const X = (t) => this.left + ((t - begin) / (end - begin || 1)) * (w - this.left - 8);
    const Y = (v) => bottom - ((v - low) / (high - low)) * (bottom - top);
    pen.lineWidth = 1; pen.strokeStyle = rule; pen.fillStyle = ink;
    pen.textAlign = "right"; pen.textBaseline = "middle";
    for (const t of ticks) {
      pen.beginPath(); pen.moveTo(this.left, Math.round(Y(t)) + 0.5); pen.lineTo(w - 8, Math.round(Y(t)) + 0.5); pen.stroke();
      pen.fillText(shown(t), this.left - 5, Y(t));
    }
    pen.textAlign = "center"; pen.textBaseline = "top";
    for (const t of niceTicks(begin, end, 5)) pen.fillText(shown(t), X(t), bottom + 5);
    pen.textAlign = "left"; pen.fillText(`[${this.unit}]`, 2, 0);
    pen.textAlign = "right"; pen.fillText("t [s]", w - 8, 0);
    pen.save(); pen.beginPath(); pen.rect(this.left, top - 4, w - this.left - 8, bottom - top + 8); pen.clip();
    for (const { values, times, channel, colour, dashed } of this.lines) {
      pen.strokeStyle = LINES[theme][colour]; pen.lineWidth = dashed ? 1.3 : 1.7; pen.setLineDash(dashed ? [5, 3] : []);
      pen.beginPath();
      let down = false;
      for (let k = 0; k < values.length; k++) {
        if (!Number.isFinite(values[k])) { down = false; continue; }
        const x = X(times[k]), y = Y(values[k] * channel.factor);
        if (down) pen.lineTo(x, y); else pen.moveTo(x, y);
        down = true;
      }
      pen.stroke();
    }
    pen.restore();
    for (const line of this.lines) line.mark.style.borderTopColor = LINES[theme][line.colour];
    this.width = w - this.left - 8;
  }

  tell(t) {
    const part = (t - begin) / (end - begin || 1);
    this.mark.style.transform = `translateX(${this.left + part * this.width}px)`;
    for (const { values, times, channel, value } of this.lines) value.textContent = shown(between(values, locate(times, t)) * channel.factor);
  }
}

function element(parent, tag, name) {
  const made = document.createElement(tag);
  if (name) made.className = name;
  parent.append(made);
  return made;
}

function drawsOnProcessor() {
  const context = document.createElement("canvas").getContext("webgl2");
  const names = context?.getExtension("WEBGL_debug_renderer_info");
  const name = names ? String(context.getParameter(names.UNMASKED_RENDERER_WEBGL)) : "";
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}
