const ORIGIN_COLOURS = { surface: "#0072b2", column: "#009e73", bottom: "#d55e00", background: "#7f7f7f" };
const COUNTS_COLOUR = "#303030";
const LEAST_SHOWN = 1e-3;

/** Waveforms of the marked pixels, drawn one at a time below the view. */
class Waveforms {
  constructor(waveforms, curves) {
    Object.assign(this, waveforms);
    this.columns = curves;
    this.shown = -1;
  }

  /** Values of one curve of a pixel, photo-electrons or counts a bin. */
  curveOf(name, pixel) {
    const codes = this.columns[name].subarray(pixel * this.bins, (pixel + 1) * this.bins);
    if (name === "counts" || name.endsWith("_threshold")) return [...codes];
    const undo = name.endsWith("_error") ? this.error : this.light;
    return Array.from(codes, (code) => unlogged(code, undo));
  }

  show(number, picked = "") {
    this.shown = number;
    const pixel = this.pixels[number];
    element("waveform").hidden = false;
    element("waveform-title").textContent =
      `${picked}Frame ${pixel.frame}, row ${pixel.row}, column ${pixel.column}: ${pixel.outcome}`;
    this.draw();
    element("numbers").replaceChildren(...numbersOf(pixel, this.pulses).flatMap(([term, words]) => [
      make("dt", { textContent: term }), make("dd", { textContent: words })]));
  }

  hide() {
    this.shown = -1;
    element("waveform").hidden = true;
  }

  /** The next pixel to show, forwards or back; at first the first whose bottom was found. */
  step(by) {
    if (this.shown < 0) return Math.max(this.pixels.findIndex(({ outcome }) => outcome === "found"), 0);
    return (this.shown + by + this.pixels.length) % this.pixels.length;
  }

  draw() {
    if (this.shown < 0) return;
    const plots = element("plots");
    const { clientWidth: width, clientHeight: height } = plots;
    const svg = drawing("svg", { role: "img", "aria-label": this.words(), viewBox: `0 0 ${width} ${height}` });
    const pixel = this.pixels[this.shown];
    const times = Array.from({ length: this.bins }, (_, i) => pixel.firstBin + i * pixel.binWidth);
    const x = element("whole-gate").checked ? [times[0], times.at(-1)] : aboutEchoes(pixel, times);
    const room = Math.max(height - 92, 40);
    const place = { left: 62, width: width - 70, x };
    this.lightPanel(svg, { ...place, top: 20, height: 0.6 * room }, pixel, times);
    this.gatePanel(svg, { ...place, top: 34 + 0.6 * room, height: 0.4 * room }, pixel, times);
    plots.replaceChildren(svg);
  }

  words() {
    const { frame, row, column } = this.pixels[this.shown];
    return `Light by origin and counts of frame ${frame}, row ${row}, column ${column}; numbers beside`;
  }

  lightPanel(svg, place, pixel, times) {
    const counts = this.curveOf("counts", this.shown);
    const light = Object.fromEntries(["surface", "column", "bottom"].map((name) => [name, this.curveOf(name, this.shown)]));
    const low = Math.max(Math.min(pixel.background, 0.5) / 3, LEAST_SHOWN);
    const high = 2 * Math.max(...counts, ...light.surface, ...light.column, ...light.bottom, 1);
    const area = panel({ ...place, y: [low, high] });
    axes(svg, area, { yLabel: "per bin" });
    curve(area, times, counts, { stroke: COUNTS_COLOUR, "stroke-width": 0.8 });
    for (const [name, values] of Object.entries(light)) {
      const stroke = ORIGIN_COLOURS[name];
      if (name !== "surface") {
        const error = this.curveOf(`${name}_error`, this.shown);
        band(area, times, values.map((v, i) => v - error[i]), values.map((v, i) => v + error[i]), stroke);
      }
      curve(area, times, values, { stroke, "stroke-width": 1.8 });
    }
    curve(area, times, times.map(() => pixel.background), BACKGROUND_LINE);
    markTimes(area, pixel);
    depthAxis(svg, area, pixel);
  }

  gatePanel(svg, place, pixel, times) {
    const sums = gateSums(this.curveOf("counts", this.shown), this.gateBins);
    const thresholds = ["surface", "bottom"].map((name) => [name, this.curveOf(`${name}_threshold`, this.shown)]);
    const high = 2 * Math.max(...sums, ...thresholds.flatMap(([, values]) => values), 1);
    const area = panel({ ...place, y: [0.7, high] });
    axes(svg, area, { xLabel: "time after emission [ns]; dashed: threshold for a surface, for a bottom echo", yLabel: `per ${this.gateBins} bins` });
    curve(area, times, sums, { stroke: COUNTS_COLOUR, "stroke-width": 1 });
    for (const [name, values] of thresholds) {
      curve(area, times, values, { stroke: ORIGIN_COLOURS[name], "stroke-width": 1.4, "stroke-dasharray": "6 4" });
    }
    markTimes(area, pixel);
  }
}

/** Sums over a gate of odd width about every bin. */
function gateSums(counts, width) {
  const half = (width - 1) / 2;
  return counts.map((_, i) => counts.slice(Math.max(i - half, 0), i + half + 1).reduce((sum, count) => sum + count, 0));
}

/** From a little before the surface to well behind the bottom [ns]. */
function aboutEchoes(pixel, times) {
  const marked = [pixel.trueSurface, pixel.foundSurface, pixel.trueBottom, pixel.foundBottom].filter((time) => time !== null);
  if (marked.length === 0) return [times[0], times.at(-1)];
  const [low, high] = [Math.min(...marked), Math.max(...marked)];
  const room = Math.max(0.25 * (high - low), 15);
  return [Math.max(low - 0.6 * room, times[0]), Math.min(high + 1.4 * room, times.at(-1))];
}

function markTimes(area, pixel) {
  for (const name of ["surface", "bottom"]) {
    const stroke = ORIGIN_COLOURS[name];
    const suffix = name[0].toUpperCase() + name.slice(1);
    upright(area, pixel[`found${suffix}`], { stroke, ...FOUND_TIME });
    upright(area, pixel[`true${suffix}`], { stroke, ...TRUE_TIME });
  }
}

/** Depths under the true surface that times stand for, above the panel. */
function depthAxis(svg, area, { trueSurface, metresPerNs }) {
  if (trueSurface === null || metresPerNs === null) return;
  const deepest = (area.x1 - trueSurface) * metresPerNs;
  for (const depth of ticks(0, deepest, 6)) {
    const x = area.toX(trueSurface + depth / metresPerNs);
    svg.append(drawing("line", { x1: x, x2: x, y1: area.top - 4, y2: area.top, stroke: "#9aa7b0" }));
    svg.append(drawing("text", { x, y: area.top - 7, "text-anchor": "middle" }, `${tickWords(depth)} m deep`));
  }
}

const BACKGROUND_LINE = { stroke: ORIGIN_COLOURS.background, "stroke-width": 1.2, "stroke-dasharray": "5 4" };
const TRUE_TIME = { "stroke-width": 1.6, "stroke-dasharray": "1.5 2.5" };
const FOUND_TIME = { "stroke-width": 1.4 };
const KEY = [
  ["counts", { stroke: COUNTS_COLOUR }],
  ...["surface", "column", "bottom"].map((name) => [`expected of ${name}`, { stroke: ORIGIN_COLOURS[name], "stroke-width": 2.4 }]),
  ["expected background", BACKGROUND_LINE],
  ["true time", { stroke: COUNTS_COLOUR, ...TRUE_TIME }],
  ["time as ranged", { stroke: COUNTS_COLOUR, ...FOUND_TIME }],
];

/** Lines with their meaning. */
function showKey() {
  const entries = KEY.map(([words, style]) => {
    const sample = drawing("svg", { width: 22, height: 10 });
    sample.append(drawing("line", { x1: 0, x2: 22, y1: 5, y2: 5, ...style }));
    return make("span", {}, [sample, words]);
  });
  element("key").replaceChildren(...entries, "band: Monte Carlo standard error");
}

function numbersOf(pixel, pulses) {
  const metres = (value, digits = 3) => (value === null ? "none" : `${value.toFixed(digits)} m`);
  const time = (value) => (value === null ? "none" : `${value.toFixed(2)} ns`);
  return [
    ["true depth, level water", metres(pixel.trueDepth)],
    ["depth as measured", metres(pixel.depth)],
    ["error of elevation", metres(pixel.error)],
    ["vertical uncertainty, 95 %", metres(pixel.tvu)],
    ["detection probability", pixel.probability === null ? "none" : pixel.probability.toFixed(3)],
    ["surface, true", time(pixel.trueSurface)],
    ["surface, ranged", time(pixel.foundSurface)],
    ["bottom, true", time(pixel.trueBottom)],
    ["bottom, ranged", time(pixel.foundBottom)],
    ["background in a bin", pixel.background.toPrecision(3)],
    ["pulses of the frame", String(pulses)],
    ["bin", `${pixel.binWidth.toFixed(3)} ns`],
  ];
}
