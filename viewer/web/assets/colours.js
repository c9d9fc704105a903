const NO_VALUE = "#9aa0a6";

const bytesOf = (hex) => [1, 3, 5].map((place) => parseInt(hex.slice(place, place + 2), 16));

/** Numbers of one attribute for all points of the bottom. */
function valuesOf(attribute, bottom) {
  const { name } = attribute;
  if (name === "depth") return Float32Array.from(bottom.height, (height) => -height);
  if (name === "line") return bottom.line;
  if (name === "frame") return bottom.codes.frame;
  const codes = bottom.codes[name];
  if (attribute.categories) return codes;
  const undo = attribute.least ? unlogged : unrounded;
  return Float32Array.from(codes, (code) => undo(code, attribute));
}

/** Colours (n, 3) of points, one byte each. */
function painted(attribute, values) {
  const colour = attribute.categories ? categoryColour(attribute) : scaleColour(attribute);
  const bytes = new Uint8Array(3 * values.length);
  for (let i = 0; i < values.length; i++) bytes.set(colour(values[i]), 3 * i);
  return bytes;
}

function categoryColour({ categories }) {
  const table = new Map(categories.map(({ code, colour }) => [code, bytesOf(colour)]));
  return (code) => table.get(code);
}

function scaleColour(attribute) {
  const palette = attribute.palette.map(bytesOf);
  const none = bytesOf(NO_VALUE);
  const below = attribute.below && bytesOf(attribute.below.colour);
  return (value) => {
    if (Number.isNaN(value)) return none;
    if (below && value <= 0) return below;
    const share = Math.min(Math.max(shareOf(attribute, value), 0), 1);
    return palette[Math.round(share * (palette.length - 1))];
  };
}

/** Where a value lies on its scale, 0 to 1; scales of ratios are logarithmic. */
function shareOf({ range: [low, high], least }, value) {
  if (least) return Math.log(Math.max(value, least) / low) / Math.log(high / low);
  return (value - low) / (high - low);
}

const counted = (number) => number.toLocaleString("en");

/** A number with its unit, as exact as it is rounded. */
function worded(attribute, value) {
  if (attribute.categories) {
    const category = attribute.categories.find(({ code }) => code === value);
    return category ? category.label : String(value);
  }
  if (Number.isNaN(value)) return "none";
  if (attribute.least) return value.toPrecision(2);
  return attribute.unit ? `${value.toFixed(attribute.name === "thu" ? 2 : 3)} m` : String(value);
}

function showLegend(attribute) {
  const legend = element("legend");
  const title = make("h3", { textContent: attribute.label + (attribute.unit ? ` [${attribute.unit}]` : "") });
  legend.replaceChildren(title, ...(attribute.categories ? [swatches(attribute)] : scale(attribute)));
}

const make = (tag, properties = {}, children = []) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
};

function swatch(colour) {
  const made = make("span", { className: "swatch" });
  made.style.backgroundColor = colour;
  return made;
}

function swatches({ categories }) {
  const items = categories.map(({ label, colour, count }) =>
    make("li", {}, [swatch(colour), make("span", { textContent: label }), make("span", { textContent: counted(count) })]));
  return make("ul", {}, items);
}

const BAR = { left: 8, width: 254, height: 14 };

function scale(attribute) {
  const svg = drawing("svg", { viewBox: "0 0 270 38", role: "img", "aria-label": rangeWords(attribute) });
  const step = BAR.width / attribute.palette.length;
  attribute.palette.forEach((colour, i) =>
    svg.append(drawing("rect", { x: BAR.left + i * step, y: 0, width: step + 0.6, height: BAR.height, fill: colour })));
  for (const value of scaleTicks(attribute)) {
    const x = BAR.left + shareOf(attribute, value) * BAR.width;
    svg.append(drawing("line", { x1: x, x2: x, y1: BAR.height, y2: BAR.height + 5, stroke: "#1f2b33" }));
    svg.append(drawing("text", { x, y: 34, "text-anchor": "middle" }, tickWords(value)));
  }
  const below = attribute.below
    ? [make("ul", {}, [make("li", {}, [swatch(attribute.below.colour), make("span", { textContent: attribute.below.label })])])]
    : [];
  return [svg, ...below, make("p", { textContent: "Values beyond the ends take the colours of the ends." })];
}

const rangeWords = ({ label, range, unit }) => `${label}: from ${range[0]} to ${range[1]} ${unit}`;

function scaleTicks({ range: [low, high], least }) {
  return least ? logTicks(low, high, 5) : ticks(low, high, 5);
}
