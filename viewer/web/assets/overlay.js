const BAR_PIXELS = 150;

const longest = (metres) => {
  const power = 10 ** Math.floor(Math.log10(metres));
  return Math.max(...[1, 2, 5].map((step) => step * power).filter((length) => length <= metres));
};

/** Scale bar below on the left, arrow to grid north above on the right. */
function drawOverlay(view) {
  const { clientWidth: width, clientHeight: height } = view.canvas;
  const overlay = element("overlay");
  const length = longest(BAR_PIXELS * view.metresPerPixel);
  const pixels = length / view.metresPerPixel;
  const [left, base] = [20, height - 22];
  const bar = drawing("path", { d: `M${left} ${base - 6}V${base}H${left + pixels}V${base - 6}`, fill: "none", stroke: "#1f2b33", "stroke-width": 2 });
  const factor = view.upright.scale.z;
  const heights = factor === 1 ? "heights to scale" : `heights of sea and bottom × ${factor}`;
  const words = drawing("text", { x: left, y: base - 12 }, `${tickWords(length)} m across the page, ${heights}`);
  overlay.replaceChildren(bar, words, ...northArrow(view, width));
}

function northArrow({ camera }, width) {
  const [right, up] = [0, 1].map((k) => new THREE.Vector3().setFromMatrixColumn(camera.matrixWorld, k).y);
  const [x, y] = [width - 56, 58];
  const tip = [x + 34 * right, y - 34 * up];
  const tail = [x - 24 * right, y + 24 * up];
  const size = Math.hypot(right, up) || 1;
  const [ux, uy] = [right / size, -up / size];
  const head = [tip, [tip[0] - 12 * ux - 5 * uy, tip[1] - 12 * uy + 5 * ux], [tip[0] - 12 * ux + 5 * uy, tip[1] - 12 * uy - 5 * ux]];
  return [
    drawing("line", { x1: tail[0], y1: tail[1], x2: tip[0], y2: tip[1], stroke: "#1f2b33", "stroke-width": 2 }),
    drawing("polygon", { points: head.map((corner) => corner.join(",")).join(" "), fill: "#1f2b33" }),
    drawing("text", { x: tip[0] + 11 * ux, y: tip[1] + 11 * uy + 4, "text-anchor": "middle", "font-weight": "bold" }, "N"),
  ];
}
