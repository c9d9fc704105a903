const AZIMUTH = (32 * Math.PI) / 180;
const ELEVATION = (32 * Math.PI) / 180;
const LARGEST_ELEVATION = Math.PI / 2 - 1e-3;
const MARGIN = 1.12;

/** Camera, renderer and what they draw; a parallel view, so that one scale holds everywhere. */
class View {
  constructor(canvas, axis) {
    this.canvas = canvas;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.setClearColor("#f3f6f8");
    this.scene = new THREE.Scene();
    this.upright = new THREE.Group();
    this.scene.add(this.upright);
    this.camera = new THREE.OrthographicCamera(-1, 1, 1, -1, 0, 1);
    this.camera.up.set(0, 0, 1);
    this.controls = new THREE.OrbitControls(this.camera, canvas);
    this.controls.zoomToCursor = true;
    this.controls.minZoom = 0.2;
    this.controls.maxZoom = 400;
    this.controls.addEventListener("change", () => this.draw());
    this.axis = axis;
    this.contents = [];
    this.drawn = [];
    this.pending = false;
  }

  /** Metres of the scene across one pixel of the page. */
  get metresPerPixel() {
    return (this.camera.right - this.camera.left) / this.camera.zoom / this.canvas.clientWidth;
  }

  setExaggeration(factor) {
    this.upright.scale.z = factor;
    this.draw();
  }

  /** Look from the deep end's side at all the contents. */
  reset() {
    const [x, y] = this.axis;
    const level = [Math.cos(AZIMUTH) * y + Math.sin(AZIMUTH) * x, -Math.cos(AZIMUTH) * x + Math.sin(AZIMUTH) * y];
    this.lookFrom(Math.atan2(level[1], level[0]), ELEVATION);
    this.fit();
  }

  /** Look straight down, north upwards. */
  lookFromAbove() {
    this.lookFrom(-Math.PI / 2, LARGEST_ELEVATION);
    this.fit();
  }

  lookFrom(azimuth, elevation) {
    const flat = Math.cos(elevation);
    const towards = new THREE.Vector3(flat * Math.cos(azimuth), flat * Math.sin(azimuth), Math.sin(elevation));
    this.camera.position.copy(this.controls.target).addScaledVector(towards, this.distance ?? 1);
    this.camera.lookAt(this.controls.target);
    this.camera.updateMatrixWorld();
  }

  /** Move and zoom so that all contents are just seen. */
  fit() {
    const [right, up, back] = [0, 1, 2].map((k) => new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, k));
    const places = this.contents.map(([x, y, z, stretches]) =>
      new THREE.Vector3(x, y, stretches ? z * this.upright.scale.z : z));
    const extent = (direction) => {
      const along = places.map((place) => place.dot(direction));
      return [Math.min(...along), Math.max(...along)];
    };
    const middle = new THREE.Vector3();
    const spans = [right, up, back].map((direction) => {
      const [low, high] = extent(direction);
      middle.addScaledVector(direction, (low + high) / 2);
      return high - low;
    });
    this.distance = 4 * Math.max(...spans, 1);
    this.camera.far = 8 * this.distance;
    this.camera.position.copy(middle).addScaledVector(back, this.distance);
    this.controls.target.copy(middle);
    this.size = { width: MARGIN * spans[0], height: MARGIN * spans[1] };
    this.camera.zoom = 1;
    this.resize();
    this.controls.update();
    this.draw();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height || !this.size) return;
    const half = Math.max(this.size.height, (this.size.width * height) / width, 1) / 2;
    Object.assign(this.camera, { left: (-half * width) / height, right: (half * width) / height, top: half, bottom: -half });
    this.camera.updateProjectionMatrix();
    this.renderer.setPixelRatio(window.devicePixelRatio);
    this.renderer.setSize(width, height, false);
    this.draw();
  }

  /** Turn by angles [rad] about the middle of the view. */
  turn(azimuth, elevation) {
    const from = new THREE.Vector3().subVectors(this.camera.position, this.controls.target);
    const now = Math.asin(from.z / from.length());
    const next = Math.min(Math.max(now + elevation, -LARGEST_ELEVATION), LARGEST_ELEVATION);
    this.distance = from.length();
    this.lookFrom(Math.atan2(from.y, from.x) + azimuth, next);
    this.controls.update();
    this.draw();
  }

  /** Move what is seen by shares of the page's height. */
  move(right, up) {
    const height = (this.camera.top - this.camera.bottom) / this.camera.zoom;
    for (const [k, share] of [[0, right], [1, up]]) {
      const step = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, k).multiplyScalar(share * height);
      this.camera.position.add(step);
      this.controls.target.add(step);
    }
    this.controls.update();
    this.draw();
  }

  zoom(factor) {
    this.camera.zoom = Math.min(Math.max(this.camera.zoom * factor, this.controls.minZoom), this.controls.maxZoom);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  /** Draw with the next picture of the browser, once. */
  draw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => {
      this.pending = false;
      const pixelsPerMetre = window.devicePixelRatio / this.metresPerPixel;
      this.scene.traverse(({ material }) => {
        if (material?.uniforms?.pixelsPerMetre) material.uniforms.pixelsPerMetre.value = pixelsPerMetre;
      });
      this.renderer.render(this.scene, this.camera);
      for (const tell of this.drawn) tell();
    });
  }

  /** Number of the shown point of a cloud at a place of the page, -1 where none is near. */
  nearest(cloud, [x, y], within) {
    const matrix = new THREE.Matrix4().multiplyMatrices(this.camera.projectionMatrix, this.camera.matrixWorldInverse);
    const m = matrix.multiply(cloud.matrixWorld).elements;
    const places = cloud.geometry.attributes.position.array;
    const { start, count } = cloud.geometry.drawRange;
    const end = Math.min(start + count, places.length / 3);
    const [halfWidth, halfHeight] = [this.canvas.clientWidth / 2, this.canvas.clientHeight / 2];
    let [found, best] = [-1, Infinity];
    for (let i = start; i < end; i++) {
      const [px, py, pz] = [places[3 * i], places[3 * i + 1], places[3 * i + 2]];
      const dx = (m[0] * px + m[4] * py + m[8] * pz + m[12] + 1) * halfWidth - x;
      const dy = (1 - (m[1] * px + m[5] * py + m[9] * pz + m[13])) * halfHeight - y;
      const distance = dx * dx + dy * dy;
      if (distance < best) [found, best] = [i, distance];
    }
    return best <= within * within ? found : -1;
  }
}
