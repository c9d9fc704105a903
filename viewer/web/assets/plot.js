function drawing(tag, attributes = {}, text = "") {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.textContent = text;
  return made;
}

/** Round numbers between two, about so many. */
function ticks(low, high, wanted) {
  const raw = (high - low) / wanted;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => size >= raw * 0.999);
  const first = Math.ceil(low / step - 1e-6);
  const count = Math.floor(high / step + 1e-6) - first + 1;
  return Array.from({ length: count }, (_, i) => (first + i) * step);
}

/** Powers of ten between two; with less than two decades 1, 2 and 5 times them. */
function logTicks(low, high, wanted) {
  const steps = Math.log10(high / low) < 2 ? [1, 2, 5] : [1];
  const found = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power++) {
    for (const step of steps) {
      const value = step * 10 ** power;
      if (value >= low * 0.999 && value <= high * 1.001) found.push(value);
    }
  }
  const every = Math.ceil(found.length / wanted);
  return found.filter((_, i) => i % every === 0);
}

const tickWords = (value) => String(Number(value.toPrecision(4))).replace("-", "−");

const SUPERSCRIPTS = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

function powerWords(value) {
  const power = Math.round(Math.log10(value));
  if (Math.abs(Math.log10(value) - power) > 1e-6 || (power >= -1 && power <= 3)) return tickWords(value);
  return "10" + [...String(power)].map((digit) => SUPERSCRIPTS[digit]).join("");
}

/** A panel with a linear x and a logarithmic y, in pixels of the drawing. */
function panel({ left, top, width, height, x: [x0, x1], y: [y0, y1] }) {
  const toX = (x) => left + ((x - x0) / (x1 - x0)) * width;
  const share = (y) => Math.log(Math.max(y, y0 * 1e-3) / y0) / Math.log(y1 / y0);
  const toY = (y) => top + height * (1 - share(y));
  const clipped = drawing("svg", { x: left, y: top, width, height, viewBox: `${left} ${top} ${width} ${height}` });
  return { left, top, width, height, x0, x1, y0, y1, toX, toY, clipped };
}

function axes(svg, area, { xLabel, yLabel }) {
  const { left, top, width, height, x0, x1, y0, y1, toX, toY } = area;
  for (const y of logTicks(y0, y1, 5)) {
    svg.append(drawing("line", { x1: left, x2: left + width, y1: toY(y), y2: toY(y), stroke: "#e3e8eb" }));
    svg.append(drawing("text", { x: left - 6, y: toY(y) + 4, "text-anchor": "end" }, powerWords(y)));
  }
  for (const x of ticks(x0, x1, Math.max(width / 90, 2))) {
    svg.append(drawing("line", { x1: toX(x), x2: toX(x), y1: top, y2: top + height, stroke: "#e3e8eb" }));
    if (xLabel) svg.append(drawing("text", { x: toX(x), y: top + height + 15, "text-anchor": "middle" }, tickWords(x)));
  }
  svg.append(drawing("rect", { x: left, y: top, width, height, fill: "none", stroke: "#9aa7b0" }));
  if (xLabel) svg.append(drawing("text", { x: left + width / 2, y: top + height + 31, "text-anchor": "middle" }, xLabel));
  svg.append(area.clipped);
  const middle = top + height / 2;
  svg.append(drawing("text", { x: 13, y: middle, "text-anchor": "middle", transform: `rotate(-90 13 ${middle})` }, yLabel));
}

/** A curve through (x, y) of the bins, cut at the edges of the panel. */
function curve(area, xs, ys, style) {
  const points = xs.flatMap((x, i) => (inside(area, x) ? [`${area.toX(x).toFixed(1)},${area.toY(ys[i]).toFixed(1)}`] : []));
  area.clipped.append(drawing("polyline", { points: points.join(" "), fill: "none", ...style }));
}

function band(area, xs, low, high, fill) {
  const shown = xs.map((_, i) => i).filter((i) => inside(area, xs[i]));
  const at = (i, ys) => `${area.toX(xs[i]).toFixed(1)},${area.toY(ys[i]).toFixed(1)}`;
  const points = [...shown.map((i) => at(i, high)), ...shown.reverse().map((i) => at(i, low))];
  area.clipped.append(drawing("polygon", { points: points.join(" "), fill, "fill-opacity": 0.25 }));
}

const inside = ({ x0, x1 }, x) => x >= x0 && x <= x1;

function upright(area, x, style) {
  if (x === null || !inside(area, x)) return;
  area.clipped.append(drawing("line", { x1: area.toX(x), x2: area.toX(x), y1: area.top, y2: area.top + area.height, ...style }));
}
