// Shows a tileset with CesiumJS, and how its outline differs from that of the partitions.
const Cesium = window.Cesium;

const widget = new Cesium.CesiumWidget('scene', {
  baseLayer: false,
  globe: false,
  skyBox: false,
  skyAtmosphere: false,
  contextOptions: { webgl: { preserveDrawingBuffer: true } },
});
const { scene } = widget;
scene.backgroundColor = Cesium.Color.BLACK;  // without normals it draws plain white
scene.light = new Cesium.DirectionalLight({ direction: new Cesium.Cartesian3(0.3, 1, -0.4) });

let tileset = null;
let failures = [];
const outlines = [];

async function load({ tileset: url }) {
  failures = [];
  tileset = await Cesium.Cesium3DTileset.fromUrl(url, { backFaceCulling: false });
  tileset.tileFailed.addEventListener(({ url: failed, message }) => failures.push(`${failed}: ${message}`));
  scene.primitives.add(tileset);
}

function look({ direction, distance }) {
  const { center, radius } = tileset.boundingSphere;
  const from = Cesium.Cartesian3.normalize(new Cesium.Cartesian3(...direction), new Cesium.Cartesian3());
  const offset = Cesium.Cartesian3.multiplyByScalar(from, distance * radius, new Cesium.Cartesian3());
  scene.camera.frustum.near = 0.001 * radius;
  scene.camera.frustum.far = 100 * radius;
  scene.camera.lookAtTransform(Cesium.Matrix4.fromTranslation(center), offset);
}

/// Refines until nothing is left to do for `errorTarget` pixels.
async function settle(errorTarget) {
  tileset.maximumScreenSpaceError = errorTarget;
  const names = new Set();
  const note = (tile) => names.add(new URL(tile.content.url, location.href).pathname);
  await new Promise((resolve) => {
    let frames = 0;
    const stop = scene.postRender.addEventListener(() => {
      frames = tileset.tilesLoaded ? frames + 1 : 0;
      if (frames < 10) return;
      stop();
      resolve();
    });
  });
  tileset.tileVisible.addEventListener(note);
  scene.render();
  tileset.tileVisible.removeEventListener(note);
  return { visible: [...names].sort(), failures };
}

/// Keeps what is covered now.
function keepOutline() {
  const { canvas } = scene;
  const gl = canvas.getContext('webgl2') ?? canvas.getContext('webgl');
  const pixels = new Uint8Array(canvas.width * canvas.height * 4);
  scene.render();
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  const covered = new Uint8Array(canvas.width * canvas.height);
  for (let i = 0; i < covered.length; ++i) {
    covered[i] = pixels[4 * i] > 5 || pixels[4 * i + 1] > 5 || pixels[4 * i + 2] > 5 ? 1 : 0;
  }
  outlines.push({ covered, width: canvas.width });
}

/// Whether all pixels within `reach` of pixel `i` are covered.
function coveredAround({ covered, width }, i, reach) {
  const height = covered.length / width;
  const [x, y] = [i % width, Math.floor(i / width)];
  for (let v = Math.max(0, y - reach); v <= Math.min(height - 1, y + reach); ++v) {
    for (let u = Math.max(0, x - reach); u <= Math.min(width - 1, x + reach); ++u) {
      if (!covered[v * width + u]) return false;
    }
  }
  return true;
}

/// How the outline kept first differs from that kept last; holes as three_page.mjs has them.
function compare(errorTarget) {
  const [ours, theirs] = [outlines.at(0), outlines.at(-1)];
  const reach = Math.ceil(errorTarget) + 1;
  let covered = 0, outline = 0, holes = 0;
  for (let i = 0; i < ours.covered.length; ++i) {
    covered += theirs.covered[i];
    if (ours.covered[i] !== theirs.covered[i]) ++outline;
    if (!ours.covered[i] && coveredAround(theirs, i, reach)) ++holes;
  }
  outlines.length = 0;
  return { covered, outline: outline / covered, holes };
}

window.view = { load, look, settle, keepOutline, compare };
