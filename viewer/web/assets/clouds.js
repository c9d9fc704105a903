const VERTEX = `
attribute vec3 color;
uniform float metres, pixelsPerMetre, leastPixels;
varying vec3 shade;
void main() {
  shade = color;
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  gl_PointSize = clamp(metres * pixelsPerMetre, leastPixels, 60.0);
}`;
const DISC = `
uniform float opacity;
varying vec3 shade;
void main() {
  vec2 place = 2.0 * gl_PointCoord - 1.0;
  if (dot(place, place) > 1.0) discard;
  gl_FragColor = vec4(shade, opacity);
}`;
const RING = `
varying vec3 shade;
void main() {
  float radius = length(2.0 * gl_PointCoord - 1.0);
  if (radius > 1.0) discard;
  gl_FragColor = vec4(radius > 0.62 ? vec3(0.12, 0.17, 0.2) : shade, 1.0);
}`;
const CIRCLE = `
varying vec3 shade;
void main() {
  float radius = length(2.0 * gl_PointCoord - 1.0);
  if (radius > 1.0 || radius < 0.68) discard;
  gl_FragColor = vec4(shade, 1.0);
}`;

function dotMaterial(fragmentShader, more = {}) {
  const uniforms = { metres: { value: 0 }, pixelsPerMetre: { value: 1 }, leastPixels: { value: 2 }, opacity: { value: 1 } };
  return new THREE.ShaderMaterial({ vertexShader: VERTEX, fragmentShader, uniforms, ...more });
}

/** Points with places about the middle of the survey, heights above the water level. */
function dots(places, colours, material) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(places, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3, true));
  const made = new THREE.Points(geometry, material);
  made.frustumCulled = false;
  return made;
}

function plain(count, colour) {
  const bytes = new Uint8Array(3 * count);
  for (let i = 0; i < count; i++) bytes.set(bytesOf(colour), 3 * i);
  return bytes;
}

/** Places (n, 3) of a packed cloud [m]. */
function placesOf(columns, steps, { middle, level }) {
  const count = columns.x.length;
  const places = new Float32Array(3 * count);
  const shift = [middle[0], middle[1], level];
  ["x", "y", "z"].forEach((axis, k) => {
    const { step, start } = steps[axis];
    const codes = columns[axis];
    for (let i = 0; i < count; i++) places[3 * i + k] = (start + codes[i] - 1) * step - shift[k];
  });
  return places;
}

/** Middle of the extent of a packed cloud [m, local]. */
function middleOf(columns, steps) {
  return ["x", "y"].map((axis) => {
    let [low, high] = [Infinity, -Infinity];
    for (const code of columns[axis]) {
      if (code < low) low = code;
      if (code > high) high = code;
    }
    return (steps[axis].start + (low + high) / 2 - 1) * steps[axis].step;
  });
}

/** First place in ascending values that is not below a limit. */
function firstFrom(values, limit) {
  let [low, high] = [0, values.length];
  while (low < high) {
    const half = (low + high) >> 1;
    if (values[half] < limit) low = half + 1;
    else high = half;
  }
  return low;
}

/** Show the points of frames first to last alone; they lie in the order of frames. */
function showFrames(cloud, frames, first, last) {
  const start = firstFrom(frames, first);
  cloud.geometry.setDrawRange(start, firstFrom(frames, last + 1) - start);
}

/** The true seabed as a mesh, with holes where there is none. */
function seabedMesh(grid, codes, { middle, level }) {
  const { columns, rows, cell } = grid;
  const places = new Float32Array(3 * columns * rows);
  for (let i = 0; i < columns * rows; i++) {
    places[3 * i] = grid.x + (i % columns) * cell - middle[0];
    places[3 * i + 1] = grid.y + Math.floor(i / columns) * cell - middle[1];
    places[3 * i + 2] = unrounded(codes[i], grid) - level;
  }
  const triangles = [];
  for (let row = 0; row + 1 < rows; row++) {
    for (let column = 0; column + 1 < columns; column++) {
      const corner = row * columns + column;
      const square = [corner, corner + 1, corner + columns + 1, corner + columns];
      if (square.some((node) => codes[node] === 0)) continue;
      triangles.push(square[0], square[1], square[2], square[0], square[2], square[3]);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(places.map((value) => value || 0), 3));
  geometry.setIndex(triangles);
  geometry.computeVertexNormals();
  const material = new THREE.ShaderMaterial({ vertexShader: RELIEF, fragmentShader: SHADED, side: THREE.DoubleSide });
  const made = new THREE.Mesh(geometry, material);
  made.frustumCulled = false;
  return made;
}

const RELIEF = `
varying float light;
void main() {
  vec3 upright = normalize(vec3(normal.xy * 4.0, normal.z));
  light = 0.62 + 0.33 * dot(upright, normalize(vec3(-0.6, 0.5, 0.7)));
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;
const SHADED = `
varying float light;
void main() { gl_FragColor = vec4(light * vec3(0.80, 0.83, 0.87), 1.0); }`;
