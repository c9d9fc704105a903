const FLIGHT_COLOUR = "#c4500c";
const LIGHT_COLOUR = "#1c7c3a";
const AIRCRAFT = [
  [0.5, 0], [0.22, 0.05], [-0.08, 0.6], [-0.2, 0.6], [-0.06, 0.05], [-0.38, 0.04], [-0.5, 0.22], [-0.56, 0.22],
  [-0.5, 0], [-0.56, -0.22], [-0.5, -0.22], [-0.38, -0.04], [-0.06, -0.05], [-0.2, -0.6], [-0.08, -0.6], [0.22, -0.05],
];

function lineOf(places, colour, Kind = THREE.Line) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places.flat()), 3));
  const made = new Kind(geometry, new THREE.LineBasicMaterial({ color: colour }));
  made.frustumCulled = false;
  return made;
}

/** Flight lines to scale; aircraft, its light and footprint at one frame. */
class Flight {
  constructor(flight, { middle, level }) {
    this.flight = flight;
    this.shift = ([x, y, z]) => [x - middle[0], y - middle[1], z - level];
    this.group = new THREE.Group();
    this.moving = new THREE.Group();
    const lines = new Map();
    flight.line.forEach((line, i) => lines.set(line, [...(lines.get(line) ?? []), this.shift(flight.position[i])]));
    for (const places of lines.values()) this.group.add(lineOf(places, FLIGHT_COLOUR));
    this.group.add(this.moving);
  }

  /** Corners of everything that must be seen. */
  get places() {
    return this.flight.position.map(this.shift);
  }

  /** Draw aircraft and light of a place in the list of frames. */
  show(number, { exaggeration, length }) {
    for (const old of this.moving.children) old.geometry.dispose();
    this.moving.clear();
    const sensor = this.shift(this.flight.position[number]);
    const corners = this.flight.corners[number].map(this.shift).map(([x, y, z]) => [x, y, z * exaggeration]);
    const rays = corners.flatMap((corner) => [sensor, corner]);
    this.moving.add(lineOf(corners, LIGHT_COLOUR, THREE.LineLoop));
    this.moving.add(lineOf(rays, LIGHT_COLOUR, THREE.LineSegments));
    this.moving.add(this.aircraft(sensor, this.flight.heading[number], length));
  }

  aircraft([x, y, z], heading, length) {
    const [east, north] = [Math.sin(heading), Math.cos(heading)];
    const outline = AIRCRAFT.map(([ahead, right]) => [
      x + length * (ahead * east + right * north), y + length * (ahead * north - right * east), z]);
    const geometry = new THREE.BufferGeometry();
    const fan = outline.flatMap((corner, i) => [[x, y, z], corner, outline[(i + 1) % outline.length]]);
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(fan.flat()), 3));
    const made = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: "#26323a", side: THREE.DoubleSide }));
    made.frustumCulled = false;
    return made;
  }
}
