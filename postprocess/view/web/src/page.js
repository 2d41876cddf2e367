// The page of `trisk view`: what is shown, and how the controls change it.

import { showBars } from "./bars.js";
import { followKeys, followPointer } from "./controls.js";
import { Field, rounded } from "./fields.js";
import { inDigits, powerFor, tenTo } from "./numbers.js";
import { coastOf, ringsOf } from "./outlines.js";
import { Picker } from "./picking.js";
import { clamp } from "./projections.js";
import { Picture } from "./scene.js";
import { surfaceOf } from "./surfaces.js";
import { bytesOf } from "./unpack.js";

const NOUNS = { nCells: "cell", nEdges: "edge", nVertices: "vertex" };
const MILLISECONDS_A_SNAPSHOT = 160;
const SOME = 4; // magnification that every mesh allows; others allow as much as brings one cell to fill the picture

const part = (id) => document.getElementById(id);

class Page {
  constructor(content) {
    this.content = content;
    this.fields = content.fields.map((about) => new Field(about, content.mesh.places[about.place].count));
    this.palettes = content.palettes.map((each) => ({ ...each, colours: bytesOf(each.colours) }));
    this.panes = Math.max(1, content.panes.length);
    this.surface = surfaceOf(content.mesh);
    this.state = { projection: Object.keys(this.surface.views)[0], row: 0, panes: this.panes, pointed: -1 };
    this.places = {};
    this.pointer = null;
    this.closest = Math.max(SOME, 1 / content.mesh.spacing);
  }

  async open() {
    this.picture = new Picture(part("canvas"), this.surface);
    for (const palette of this.palettes) palette.texture = this.picture.palette(palette.colours);
    this.fill();
    await this.surface.load();
    this.state.camera = { ...this.surface.start };
    this.picture.addFrame();
    this.picture.addLines(this.surface.coast(await coastOf(this.content.mesh)), 3, this.picture.coastInk);
    await this.choose(0);
    this.listen();
    part("message").hidden = true;
  }

  /** Fill the lists and the slider. */
  fill() {
    const option = (text, value) => new Option(text, value);
    part("field").append(...this.fields.map((field, i) => option(field.name.replaceAll("_", " "), i)));
    part("palette").append(...this.palettes.map((palette) => option(palette.name, palette.name)));
    part("titles").append(...this.content.panes.map((text) => Object.assign(document.createElement("span"), { textContent: text })));
    part("projection").parentElement.hidden = this.surface.views[part("projection").value] === undefined;
    part("slider").parentElement.hidden = part("range").parentElement.hidden = this.content.days.length === 0;
    part("slider").max = this.content.days.length - 1;
    part("play").disabled = this.content.days.length < 2;
  }

  listen() {
    part("field").addEventListener("change", (event) => this.choose(Number(event.target.value)));
    part("palette").addEventListener("change", () => this.colour());
    part("range").addEventListener("change", () => this.colour());
    part("projection").addEventListener("change", (event) => this.project(event.target.value));
    part("whole").addEventListener("click", () => {
      this.state.camera = { ...this.surface.start };
      this.move();
    });
    part("slider").addEventListener("input", (event) => this.show(Number(event.target.value)));
    part("play").addEventListener("click", () => this.play());
    followPointer(part("stage"), {
      turn: (dx, dy) => this.turn(dx, dy),
      zoom: (factor, x, y) => this.zoom(factor, x, y),
      point: (x, y) => this.point(x, y),
      leave: () => this.point(null),
    });
    followKeys({
      step: (by) => this.show(clamp(this.state.row + by, 0, Math.max(0, this.content.days.length - 1))),
      play: () => this.play(),
      turn: (dx, dy) => this.turn(dx, dy),
      zoom: (factor) => this.zoom(factor),
    });
    new ResizeObserver(() => this.redraw()).observe(part("stage"));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redraw());
  }

  /** Polygons, and what finds them, of a place of fields; made when first needed. */
  async place(name) {
    this.places[name] ??= (async () => {
      const rings = await ringsOf(this.content.mesh.places[name], this.content.mesh.numberBits);
      const fans = this.surface.fans(rings);
      const picker = new Picker(this.surface, rings, fans.centres, this.content.mesh.closed);
      return { layer: this.picture.addPatches(fans), picker };
    })();
    return this.places[name];
  }

  async choose(number) {
    const field = this.fields[number];
    const [place] = await Promise.all([this.place(field.place), field.load()]);
    this.shown?.textures.forEach((texture) => texture.dispose());
    const textures = field.panes.map(() => this.picture.texture(field.count, field.bits));
    this.shown = { field, place, textures };
    part("field").value = number;
    const kind = this.palettes.find((palette) => palette.diverging === field.bothSigns);
    part("palette").value = kind.name;
    part("note").textContent = `values to ${field.bits} bits`;
    this.show(this.state.row);
  }

  /** Show the snapshot of number `row`. */
  show(row) {
    this.state.row = row;
    const { field, textures } = this.shown;
    textures.forEach((texture, pane) => this.picture.fill(texture, field.row(pane, row)));
    const day = this.content.days.length ? `day ${Number(this.content.days[row].toFixed(4))}` : "";
    part("slider").value = row;
    part("day").textContent = day;
    part("slider").setAttribute("aria-valuetext", day);
    this.colour();
  }

  /** Colours of each pane: runs have one range in common, their difference its own. */
  colour() {
    const { field } = this.shown;
    const row = part("range").value === "day" ? this.state.row : null;
    const chosen = this.palettes.find((palette) => palette.name === part("palette").value);
    const diverging = chosen.diverging ? chosen : this.palettes.find((palette) => palette.diverging);
    const groups = this.panes === 1 ? [[0]] : [[0, 1], [2]];
    this.colours = [];
    const bars = groups.map((panes, group) => {
      const range = rounded(field.limits(panes, row));
      const palette = group === 0 ? chosen : diverging;
      for (const pane of panes) this.colours[pane] = { palette, range };
      return { colours: palette.colours, range, meaning: group === 0 ? field.meaning : "difference", units: field.units };
    });
    showBars(part("bars"), bars);
    this.read();
    this.redraw();
  }

  play() {
    const playing = this.timer !== undefined;
    clearInterval(this.timer);
    this.timer = undefined;
    if (!playing && this.content.days.length > 1) this.timer = setInterval(() => this.show((this.state.row + 1) % this.content.days.length), MILLISECONDS_A_SNAPSHOT);
    part("play").textContent = this.timer === undefined ? "Play" : "Pause";
    part("play").setAttribute("aria-pressed", String(this.timer !== undefined));
  }

  /** Show the globe or the map. */
  project(name) {
    this.state.projection = name;
    part("projection").value = name;
    this.move();
  }

  turn(dx, dy) {
    this.surface.turn(this.state.camera, dx, dy, this.picture.framing(this.state), this.state.projection);
    this.move();
  }

  /** Zoom so that the place at a point of the stage stays there, or about the middle. */
  zoom(factor, x = null, y = null) {
    const { camera } = this.state;
    const before = x === null ? null : this.seen(x, y)?.place;
    camera.zoom = clamp(camera.zoom * factor, 0.5, this.closest);
    const after = before && this.seen(x, y)?.place;
    if (after) this.surface.hold(camera, before, after, this.picture.framing(this.state));
    this.move();
  }

  /** The pane and the place at a point of the stage; null where no place is seen. */
  seen(x, y) {
    const { width, height, boxes, scale, middle } = this.picture.framing(this.state);
    const pane = boxes.findIndex((box) => x >= box.x && x < box.x + width && y >= box.y && y < box.y + height);
    if (pane < 0) return null;
    const [right, up] = [(x - boxes[pane].x - width / 2) / scale + middle[0], (height / 2 - y + boxes[pane].y) / scale + middle[1]];
    const place = this.surface.views[this.state.projection].place(right, up, this.state.camera);
    return place && { pane, place };
  }

  point(x, y) {
    this.pointer = x === null ? null : [x, y];
    this.read();
    this.redraw();
  }

  move() {
    this.read();
    this.redraw();
  }

  /** Tell number, value and place of what is under the pointer. */
  read() {
    const seen = this.pointer && this.seen(...this.pointer);
    const { surface } = this;
    const number = seen ? this.shown.place.picker.at(seen.place, this.state.camera) : -1;
    this.state.pointed = number;
    this.reading = null;
    let text = seen ? `${surface.outside} at ${surface.inWords(seen.place)}` : "Point at a cell to read its value.";
    if (number >= 0) {
      const { field } = this.shown;
      const values = field.panes.map((_, pane) => field.value(pane, this.state.row, number));
      const place = surface.home(seen.place);
      this.reading = { number, place, pane: seen.pane, values };
      text = `${NOUNS[field.place]} ${number} at ${surface.inWords(place)}: ${values.map((value, pane) => this.inWords(value, pane)).join("; ")}`;
    }
    part("reading").textContent = text;
  }

  inWords(value, pane) {
    const { field } = this.shown;
    if (value === null) return "no value";
    const { low, high } = field.panes[pane];
    const power = powerFor(Math.max(Math.abs(low), Math.abs(high)));
    const step = field.step(pane);
    const number = `${inDigits(value, step, power)}${step > 0 ? ` ± ${inDigits(step / 2, step / 2, power)}` : ""}`;
    const units = [power === 0 ? "" : `× ${tenTo(power)}`, field.units].filter(Boolean).join(" ");
    const which = this.panes === 1 ? "" : `${["first", "second", "difference"][pane]} `;
    return `${which}${step > 0 && power !== 0 ? `(${number})` : number}${units ? ` ${units}` : ""}`;
  }

  placeTitles() {
    const { width, boxes } = this.picture.framing(this.state);
    [...part("titles").children].forEach((title, pane) => {
      title.style.cssText = `left:${boxes[pane].x}px;top:${boxes[pane].y}px;width:${width}px`;
    });
  }

  redraw() {
    this.waiting ??= requestAnimationFrame(() => {
      this.waiting = undefined;
      this.draw();
    });
  }

  draw() {
    const { field, place, textures } = this.shown;
    this.placeTitles();
    const land = getComputedStyle(document.documentElement).getPropertyValue("--land").trim();
    this.picture.uniforms.land.value.set(...[1, 3, 5].map((k) => parseInt(land.slice(k, k + 2), 16) / 255));
    const panes = textures.map((texture, pane) => {
      const { palette, range } = this.colours[pane];
      const width = range[1] - range[0];
      return { texture, missing: field.missing, palette: palette.texture, scale: field.step(pane) / width, offset: (field.panes[pane].low - range[0]) / width };
    });
    this.picture.draw(this.state, panes, place.layer);
    this.frames = (this.frames ?? 0) + 1;
  }
}

async function start() {
  const content = JSON.parse(part("data").textContent);
  const page = new Page(content);
  window.trisk = page; // for tests, and for the curious
  await page.open();
}

start().catch((error) => {
  part("message").textContent = `This page cannot be shown: ${error.message}. It needs a browser with WebGL 2.`;
  console.error(error);
});
