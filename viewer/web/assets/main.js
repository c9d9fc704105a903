const SURFACE_COLOUR = "#2f7fb0";
const OTHER_COLOUR = "#b03a5b";
const FOUND_COLOUR = "#ffffff";
const MISSED_COLOUR = "#d55e00";
const CHOSEN_COLOUR = "#e6007a";
const POINTED_COLOUR = "#1f2b33";
const COVER = 1.25;
const VEIL = 0.3;
const MARK_PIXELS = 7;
const CHOSEN_PIXELS = 19;
const POINTED_PIXELS = 11;
const POINT_PIXELS = 15;
const CLICK_PIXELS = 4;

/** The page: its data, its view, and what the controls do. */
class App {
  constructor(data) {
    this.data = data;
    this.shown = {};
  }

  async open() {
    const { data } = this;
    const [columns, codes, surface, other] = await Promise.all([
      unpacked(data.clouds.bottom), unpacked(data.clouds.bottom.attributes),
      unpacked(data.clouds.surface), unpacked(data.clouds.other)]);
    this.shift = { middle: middleOf(columns, data.clouds.bottom.places), level: data.waterLevel };
    this.frames = { bottom: columns.frame, surface: surface.frame, other: other.frame };
    this.view = new View(element("canvas"), data.axis);
    this.addBottom(columns, codes);
    this.addPlain("surface", surface, SURFACE_COLOUR);
    this.addPlain("other", other, OTHER_COLOUR);
    await this.addSeabed();
    await this.addMarks();
    this.flight = new Flight(data.flight, this.shift);
    this.view.scene.add(this.flight.group);
    this.shown.flight = this.flight.group;
    this.view.contents = [...corners(this.places), ...this.flight.places.map((place) => [...place, false])];
  }

  addBottom(columns, codes) {
    const { clouds, flight } = this.data;
    this.places = placesOf(columns, clouds.bottom.places, this.shift);
    const line = new Map(flight.frame.map((frame, i) => [frame, flight.line[i]]));
    this.bottom = {
      codes: { ...codes, frame: columns.frame },
      height: this.places.filter((_, i) => i % 3 === 2),
      line: Int32Array.from(columns.frame, (frame) => line.get(frame)),
      pixel: columns.pixel,
    };
    this.cloud = dots(this.places, plain(columns.x.length, NO_VALUE), dotMaterial(DISC));
    this.pointed = newCircle(POINTED_COLOUR, POINTED_PIXELS);
    this.view.upright.add(this.cloud, this.pointed);
  }

  addPlain(name, columns, colour) {
    const places = placesOf(columns, this.data.clouds[name].places, this.shift);
    const cloud = dots(places, plain(columns.x.length, colour), dotMaterial(DISC, { transparent: true, depthWrite: false }));
    cloud.material.uniforms.opacity.value = VEIL;
    this.shown[name] = cloud;
    this.view.upright.add(cloud);
    if (columns.x.length === 0) disable(`show-${name}`);
  }

  async addSeabed() {
    const { seabed } = this.data;
    if (!seabed) return disable("show-seabed");
    const { z } = await unpacked(seabed.elevation);
    this.shown.seabed = seabedMesh(seabed, z, this.shift);
    this.view.upright.add(this.shown.seabed);
  }

  async addMarks() {
    const { waveforms } = this.data;
    if (!waveforms) {
      disable("next-mark");
      element("marks-words").hidden = true;
      return disable("show-marks");
    }
    this.waveforms = new Waveforms(waveforms, await unpacked(waveforms.curves));
    const { pixels } = waveforms;
    const places = new Float32Array(pixels.flatMap(({ x, y, z }) =>
      [x - this.shift.middle[0], y - this.shift.middle[1], z - this.shift.level]));
    const colours = new Uint8Array(pixels.flatMap(({ outcome }) =>
      bytesOf(outcome === "found" || outcome === "dry" ? FOUND_COLOUR : MISSED_COLOUR)));
    const material = dotMaterial(RING, { depthTest: false, transparent: true });
    this.frames.marks = pixels.map(({ frame }) => frame);
    this.shown.marks = dots(places, colours, material);
    this.shown.marks.renderOrder = 1;
    this.chosen = newCircle(CHOSEN_COLOUR, CHOSEN_PIXELS);
    this.view.upright.add(this.shown.marks, this.chosen);
    showKey();
  }

  colour(name = element("attribute").value) {
    element("attribute").value = name;
    this.attribute = this.data.attributes.find((attribute) => attribute.name === name);
    const { color } = this.cloud.geometry.attributes;
    color.array.set(painted(this.attribute, valuesOf(this.attribute, this.bottom)));
    color.needsUpdate = true;
    showLegend(this.attribute);
    this.view.draw();
  }

  size() {
    const metres = COVER * this.data.spacing * 2 ** Number(element("size").value);
    element("size-told").textContent = `${metres.toPrecision(2)} m`;
    for (const cloud of [this.cloud, this.shown.surface, this.shown.other]) {
      cloud.material.uniforms.metres.value = metres * (cloud === this.cloud ? 1 : 0.5);
    }
    if (this.shown.marks) this.shown.marks.material.uniforms.leastPixels.value = MARK_PIXELS * window.devicePixelRatio;
    this.view.draw();
  }

  exaggerate() {
    const factor = Number(element("exaggeration").value);
    element("exaggeration-told").textContent = `× ${factor}`;
    this.view.setExaggeration(factor);
    this.goToFrame();
  }

  /** Show what was flown up to the chosen frame, or that frame alone. */
  goToFrame() {
    const { flight } = this.data;
    const number = Number(element("frame").value);
    const [frame, line] = [flight.frame[number], flight.line[number]];
    const first = element("only-frame").checked ? frame : 0;
    const clouds = { bottom: this.cloud, ...this.shown };
    for (const [name, frames] of Object.entries(this.frames)) showFrames(clouds[name], frames, first, frame);
    element("frame-told").textContent = `${number + 1} of ${flight.frame.length}`;
    element("frame-words").textContent = `Frame ${frame}, line ${line}`;
    const length = 60 * this.view.metresPerPixel;
    this.flight.show(number, { exaggeration: this.view.upright.scale.z, length });
    this.view.draw();
  }

  stepFrame(step) {
    element("frame").value = Number(element("frame").value) + step;
    this.goToFrame();
  }

  toggle() {
    for (const [name, thing] of Object.entries(this.shown)) thing.visible = element(`show-${name}`).checked;
    this.view.draw();
  }

  /** Say what lies at a place of the page, and show the nearest waveform. */
  pick(place, within = POINT_PIXELS) {
    const mark = this.shown.marks?.visible ? this.view.nearest(this.shown.marks, place, MARK_PIXELS) : -1;
    const point = mark < 0 ? this.view.nearest(this.cloud, place, within) : this.pointOf(mark);
    if (mark < 0 && point < 0) return;
    if (point >= 0) this.showPoint(point);
    else this.hidePoint();
    if (mark >= 0) this.showMark(mark);
    else if (this.waveforms) this.showNearestMark(point);
  }

  /** The bottom point of a marked pixel, -1 where there is none. */
  pointOf(mark) {
    const { frame, row, column } = this.data.waveforms.pixels[mark];
    const pixel = row * this.data.clouds.bottom.pixelColumns + column;
    const { codes, pixel: pixels } = this.bottom;
    const start = firstFrom(codes.frame, frame);
    const found = pixels.subarray(start, firstFrom(codes.frame, frame + 1)).indexOf(pixel);
    return found < 0 ? -1 : start + found;
  }

  hidePoint() {
    element("picked").hidden = true;
    this.pointed.visible = false;
  }

  showPoint(point) {
    element("picked").hidden = false;
    element("picked").textContent = this.pointWords(point);
    circle(this.pointed, this.places, point);
    this.view.draw();
  }

  pickMiddle() {
    const { clientWidth, clientHeight } = this.view.canvas;
    this.pick([clientWidth / 2, clientHeight / 2], Infinity);
  }

  pointWords(point) {
    const { attributes, origin, clouds } = this.data;
    const [x, y, z] = this.places.subarray(3 * point, 3 * point + 3);
    const columns = clouds.bottom.pixelColumns;
    const pixel = this.bottom.pixel[point];
    const east = origin[0] + this.shift.middle[0] + x;
    const north = origin[1] + this.shift.middle[1] + y;
    const values = attributes.map((attribute) => `${attribute.label}: ${worded(attribute, valuesOf(attribute, this.one(point))[0])}`);
    return [
      `Point of frame ${this.bottom.codes.frame[point]}, row ${Math.floor(pixel / columns)}, column ${pixel % columns}`,
      `Easting ${east.toFixed(2)} m, northing ${north.toFixed(2)} m, up ${(z + this.shift.level).toFixed(3)} m`,
      ...values.filter((_, i) => attributes[i].name !== "frame"),
    ].join("\n");
  }

  /** One point as if it were the whole bottom. */
  one(point) {
    const { codes, height, line } = this.bottom;
    const part = (column) => column.subarray(point, point + 1);
    return {
      codes: Object.fromEntries(Object.entries(codes).map(([name, column]) => [name, part(column)])),
      height: part(height),
      line: part(line),
    };
  }

  showMark(number, words = "") {
    circle(this.chosen, this.shown.marks.geometry.attributes.position.array, number);
    this.waveforms.show(number, words);
    this.view.resize();
    this.waveforms.draw();
  }

  showNearestMark(point) {
    const [x, y] = this.places.subarray(3 * point, 3 * point + 2);
    const places = this.shown.marks.geometry.attributes.position.array;
    let [found, best] = [0, Infinity];
    for (let i = 0; 3 * i < places.length; i++) {
      const distance = Math.hypot(places[3 * i] - x, places[3 * i + 1] - y);
      if (distance < best) [found, best] = [i, distance];
    }
    this.showMark(found, best < 1 ? "" : `Marked pixel ${best.toFixed(0)} m from there. `);
  }

  stepMark(step) {
    if (!this.waveforms) return;
    this.hidePoint();
    this.showMark(this.waveforms.step(step));
  }

  closeWaveform() {
    this.waveforms?.hide();
    if (this.chosen) this.chosen.visible = false;
    this.hidePoint();
    this.view.resize();
  }

  listenToClicks() {
    const { canvas } = this.view;
    let down = null;
    canvas.addEventListener("pointerdown", (event) => (down = [event.offsetX, event.offsetY]));
    canvas.addEventListener("pointerup", (event) => {
      const place = [event.offsetX, event.offsetY];
      if (down && Math.hypot(place[0] - down[0], place[1] - down[1]) < CLICK_PIXELS) this.pick(place);
    });
  }
}

/** A circle about one place, hidden until it has one. */
function newCircle(colour, pixels) {
  const made = dots(new Float32Array(3), plain(1, colour), dotMaterial(CIRCLE, { depthTest: false, transparent: true }));
  made.material.uniforms.leastPixels.value = pixels * window.devicePixelRatio;
  made.renderOrder = 2;
  made.visible = false;
  return made;
}

function circle(ring, places, number) {
  ring.geometry.attributes.position.set(places.subarray(3 * number, 3 * number + 3)).needsUpdate = true;
  ring.visible = true;
}

/** Corners of the box of places, marked as stretched with the heights. */
function corners(places) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  places.forEach((value, i) => {
    low[i % 3] = Math.min(low[i % 3], value);
    high[i % 3] = Math.max(high[i % 3], value);
  });
  return Array.from({ length: 8 }, (_, i) => [...[0, 1, 2].map((k) => ((i >> k) & 1 ? high : low)[k]), true]);
}

async function start() {
  const canvas = element("canvas");
  if (!document.createElement("canvas").getContext("webgl2")) {
    element("message").textContent =
      "This browser has no WebGL 2, so the points cannot be drawn. Switch on hardware or software rendering, or open the page in another browser.";
    return;
  }
  const app = new App(JSON.parse(element("data").textContent));
  await app.open();
  wire(app);
  app.size();
  app.view.drawn.push(() => drawOverlay(app.view));
  app.view.upright.scale.z = app.data.exaggeration;
  app.view.reset();
  app.exaggerate();
  app.colour();
  app.toggle();
  app.listenToClicks();
  listenToKeys(app);
  new ResizeObserver(() => {
    app.view.resize();
    app.waveforms?.draw();
  }).observe(element("view"));
  canvas.setAttribute("aria-label", `Points of ${app.data.title}, drawn in three dimensions. Press h for the keys.`);
  element("message").hidden = true;
  document.body.dataset.ready = "yes";
}

start().catch((fault) => {
  element("message").textContent = `The page cannot be shown: ${fault.message}. A browser of 2023 or later is needed.`;
  throw fault;
});
